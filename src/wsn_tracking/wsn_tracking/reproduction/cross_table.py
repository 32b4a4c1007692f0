"""One table of everything that the comparison of all systems measures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from wsn_tracking.models.anchors import Floats
from wsn_tracking.reproduction.claims import MEASURED, Plot, Samples, Series
from wsn_tracking.reproduction.content import plain_plot
from wsn_tracking.reproduction.cross import RATES, name_of
from wsn_tracking.reproduction.cross_claims import FIVE, SHOWN, squares
from wsn_tracking.reproduction.cross_fields import FIELDS, Field
from wsn_tracking.reproduction.cross_systems import CONTENDERS
from wsn_tracking.reproduction.quantities import root_mean
from wsn_tracking.studies.intervals import known

Json = dict[str, Any]
LOSSY = RATES[1:]
COLUMNS = (
    'recording',
    'system',
    'RMSE [m]',
    '95 % interval',
    *(f'{rate:.0%} lost' for rate in LOSSY),
    'NEES (of 2)',
    'messages',
    'bytes',
)
ABOUT = (
    'All systems, a centre and two naive baselines on the same packets. RMSE of the position, also where a quarter and '
    'half of the packets are lost (each link by itself, the same for all); NEES without losses; what goes through the '
    'air in an epoch, by the nominal model: 18 bytes a measurement, 64 an estimate or a share, 10 a forwarded item and '
    '8 a broadcast; milliseconds of one core an epoch, which differ from machine to machine and from run to run, and '
    'are part of no verdict.'
)
ORIGIN = (
    'Simulated recordings: means of several, each with another seed. Real ones: radios calibrated by a survey, or by a '
    'first part that is not scored. Every system has the configuration that is made for the recording where there is '
    'one; else all are told the same facts: speed, acceleration, noise.'
)


def table(samples: Mapping[str, Samples], command: str, absent: Mapping[str, str]) -> Json:
    """Of all recordings that were run; `absent`: why others were not."""
    run = [field for field in FIELDS if name_of(field) in samples]
    rows, cpu = [], []
    for field in run:
        s = samples[name_of(field)]
        for contender in CONTENDERS:
            rows.append(_row(field, contender.name, s))
            cpu.append(_mean(s[f'{MEASURED}{contender.name}: cpu']))
    what = [f'`{field.name}`: {field.what}.' for field in run]
    for reason in dict.fromkeys(absent.values()):
        names = [f'`{name}`' for name, why in absent.items() if why == reason]
        what.append(f'Not run: {", ".join(names)}: {reason}')
    systems = ' '.join(f'`{c.name}`: {c.what}.' for c in CONTENDERS)
    return {
        'id': 'cross',
        'title': 'All systems on the same recordings',
        'text': [ABOUT, ORIGIN, systems, ' '.join(what)],
        'columns': list(COLUMNS),
        'rows': rows,
        'measured': {'CPU [ms]': cpu},
        'plots': [plain_plot(plot) for plot in _plots(run, samples)],
        'command': command,
    }


def _row(field: Field, name: str, s: Samples) -> list[Any]:
    """Of one system on one recording."""
    found = root_mean('', squares(s, name)).ours if len(squares(s, name)) > 1 else None
    ends = found['interval_95'] if found else []
    assert isinstance(ends, list)
    return [
        field.name,
        name,
        _root(squares(s, name)),
        ' to '.join(f'{end:.4g}' for end in ends),
        *(_root(squares(s, name, rate)) for rate in LOSSY),
        *(_mean(s[f'{name}{key}']) for key in (' 0: nees', ': messages', ': bytes')),
    ]


def _root(values: Floats) -> float | None:
    return known(np.sqrt(np.mean(values)))


def _mean(values: Floats) -> float | None:
    return known(np.mean(values))


def _plots(run: Sequence[Field], samples: Mapping[str, Samples]) -> list[Plot]:
    """Accuracy beside the centre, and what losses cost."""
    names = [field.name for field in run]

    def bars(name: str, above: tuple[str, float], below: tuple[str, float]) -> Series:
        parts = [samples[name_of(field)] for field in run]
        ratios = [np.sqrt(squares(s, *above).mean() / squares(s, *below).mean()) for s in parts]
        return Series(name, names, [float(r) for r in ratios])

    beside = [bars(n, (n, 0.0), ('centre', 0.0)) for n in FIVE]
    lost = [bars(n, (n, 0.5), (n, 0.0)) for n in SHOWN]
    return [
        Plot('Accuracy beside the centre', '', 'RMSE / that of the centre', beside, log_y=True),
        Plot('Half of the packets lost', '', 'RMSE / that without losses', lost, log_y=True),
    ]

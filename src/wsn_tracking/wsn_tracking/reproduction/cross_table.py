"""What the comparison of all systems shows: statements on the simulated recordings, and one table of everything."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from wsn_tracking.models.anchors import Floats
from wsn_tracking.reproduction.claims import BEYOND, MEASURED, Claim, Figure, Plot, Samples, Series
from wsn_tracking.reproduction.content import plain_plot
from wsn_tracking.reproduction.cross import RATES, SIMULATED, name_of
from wsn_tracking.reproduction.cross_fields import FIELDS, Field
from wsn_tracking.reproduction.cross_systems import CONTENDERS
from wsn_tracking.reproduction.quantities import mean, ratio, root_mean

Json = dict[str, Any]
LOSSY = RATES[1:]
FIVE = ('A', 'B', 'C', 'D', 'E')
SHOWN = ('centre', *FIVE)


def squares(s: Samples, name: str, rate: float = 0.0) -> Floats:
    """Mean squared error of each run [m^2]."""
    return s[f'{name} {rate:g}: squares']


def filtering(s: Samples) -> Sequence[Figure]:
    """The five and the centre against least squares of each epoch, and against the centre."""
    fix, centre = squares(s, 'fix'), squares(s, 'centre')
    return [
        *(ratio(f'RMSE, {n} / fix', squares(s, n), fix, True, shape=(None, 0.6)) for n in SHOWN),
        *(ratio(f'RMSE, {n} / centre', squares(s, n), centre, True, shape=(None, 1.25)) for n in ('B', 'C', 'D', 'E')),
        ratio('RMSE, A (event trigger) / centre', squares(s, 'A'), centre, True),
        ratio('measurements and estimates sent, A / centre', s['A: messages'], s['centre: messages']),
        mean('messages an epoch, B', s['B: messages']),
        root_mean('RMSE, centre', centre, 'm'),
    ]


def knowing(s: Samples) -> Sequence[Figure]:
    """A filter that knows the body, and those that do not."""
    known = squares(s, 'C')
    others = ('A', 'B', 'D', 'E', 'centre')
    return [
        *(ratio(f'RMSE, C / {n}', known, squares(s, n), True, shape=(None, 0.5)) for n in others),
        ratio('RMSE, C / C as the document has it', known, squares(s, 'C, document'), True),
        root_mean('RMSE, C', known, 'm'),
    ]


def losing(s: Samples) -> Sequence[Figure]:
    """Half of the packets."""
    return [
        *(
            ratio(
                f'RMSE, {n}, half lost / none',
                squares(s, n, 0.5),
                squares(s, n),
                True,
                shape=(None, 3.0 if n == 'A' else 1.8),
            )
            for n in SHOWN
        ),
        *(mean(f'NEES (of 2), {n}, half lost', s[f'{n} 0.5: nees']) for n in SHOWN),
    ]


CLAIMS = (
    Claim(
        'X1',
        'X',
        'a_loop',
        'On a robot among twelve nodes, all five systems are far better than places of single epochs, and those that '
        'are told every measurement are as good as one central filter, within 25 %.',
        SIMULATED['a_loop'],
        filtering,
        remark='A sends what its event trigger lets through, a third of it, and is less accurate for that.',
        kind=BEYOND,
    ),
    Claim(
        'X2',
        'X',
        'c_walk',
        'On a person whose body shades the radio, only the filter that knows the body tracks at all.',
        SIMULATED['c_walk'],
        knowing,
        remark='The others are told that signal strengths scatter by 7.2 dB, body and noise in one. It does not help: '
        'the body shifts all nodes on one side alike, towards the person or away.',
        kind=BEYOND,
    ),
    Claim(
        'X3',
        'X',
        'a_loop, half of the packets lost',
        'With half of the packets lost, no system loses its target; those that are told every measurement are at most '
        '1.8 times less accurate.',
        SIMULATED['a_loop'],
        losing,
        kind=BEYOND,
    ),
)

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


def table(samples: Mapping[str, Samples], seed: int, absent: Mapping[str, str]) -> Json:
    """Of all recordings that were run; `absent`: why others were not."""
    run = [field for field in FIELDS if name_of(field) in samples]
    rows, cpu = [], []
    for field in run:
        s = samples[name_of(field)]
        for contender in CONTENDERS:
            rows.append(_row(field, contender.name, s))
            cpu.append(_short(s[f'{MEASURED}{contender.name}: cpu']))
    what = [f'`{field.name}`: {field.what}.' for field in run]
    what += [f'`{name}` was not run: {reason}' for name, reason in absent.items()]
    systems = ' '.join(f'`{c.name}`: {c.what}.' for c in CONTENDERS)
    return {
        'id': 'cross',
        'title': 'All systems on the same recordings',
        'text': [ABOUT, ORIGIN, systems, ' '.join(what)],
        'columns': list(COLUMNS),
        'rows': rows,
        'measured': {'CPU [ms]': cpu},
        'plots': [plain_plot(plot) for plot in _plots(run, samples)],
        'command': f'./wsn-tracking reproduce X --seed {seed} --data DATA',
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
        *(_short(s[f'{name}{key}']) for key in (' 0: nees', ': messages', ': bytes')),
    ]


def _root(values: Floats) -> float | None:
    return _short(np.sqrt(values.mean(keepdims=True)))


def _short(values: Floats) -> float | None:
    """Four digits of the mean; None where nothing is known."""
    value = float(np.mean(values))
    return float(f'{value:.4g}') if np.isfinite(value) else None


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

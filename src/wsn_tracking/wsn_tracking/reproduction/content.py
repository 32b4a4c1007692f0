"""The JSON of a reproduction: all that its report shows, and all that its verdicts need."""

from __future__ import annotations

import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from wsn_tracking.reproduction.claims import Bounds, Claim, Figure, Plot, Samples, Series
from wsn_tracking.reproduction.verdicts import verdicts
from wsn_tracking.studies.intervals import known

Json = dict[str, Any]
DIGITS, DRAWN = 5, 4  # of figures, and of what is drawn: what lies beyond differs between machines


class Setting(NamedTuple):
    """How it was computed."""

    seed: int
    quick: bool
    command: str
    commit: str


def commit() -> str:
    """Of the sources, and whether they were changed since; `unknown` outside of a working copy."""
    folder = Path(__file__).resolve().parents[1]  # the whole package: filters count as much as claims

    def git(*arguments: str) -> str:
        ended = subprocess.run(
            ['git', '-C', str(folder), *arguments],  # noqa: S607
            capture_output=True,
            text=True,
            check=False,
        )
        return ended.stdout.strip() if ended.returncode == 0 else ''

    try:
        name = git('rev-parse', '--short=12', 'HEAD')
        changed = git('status', '--porcelain', '--untracked-files=no', '--', '.')
    except OSError:  # no git here
        return 'unknown'
    return f'{name} with changes' if name and changed else name or 'unknown'


def content(claims: Sequence[Claim], samples: Mapping[str, Samples], setting: Setting, **more: Any) -> Json:
    """Everything, ready for `json.dumps`; `more`: further tables, as they are."""
    plain: Json = {**setting._asdict(), 'claims': [_claim(c, samples, setting) for c in claims], **more}
    return {**plain, 'verdicts': verdicts(plain)}


def _claim(claim: Claim, samples: Mapping[str, Samples], setting: Setting) -> Json:
    e = claim.experiment
    runs = 0 if e is None else e.runs * (e.quick if setting.quick else e.units)
    given = {} if e is None else samples[e.name]
    quick = ' --quick' if setting.quick else ''
    return {
        'id': claim.id,
        'document': claim.document,
        'kind': claim.kind,
        'place': claim.place,
        'statement': claim.statement,
        'remark': claim.remark,
        'in_kind': claim.in_kind,
        'impossible': claim.impossible,
        'experiment': None if e is None else e.name,
        'runs': runs,
        'command': f'./wsn-tracking reproduce {claim.id} --seed {setting.seed}{quick}',
        'figures': [_figure(figure) for figure in claim.figures(given)],
        'plots': [plain_plot(plot) for plot in claim.plots(given)],
    }


def _figure(figure: Figure) -> Json:
    value, interval = figure.ours['value'], figure.ours['interval_95']
    assert not isinstance(value, list)
    assert isinstance(interval, list)
    return {
        'name': figure.name,
        'value': known(value, DIGITS),
        'interval_95': [known(end, DIGITS) for end in interval],
        'unit': figure.unit,
        'document': figure.document if isinstance(figure.document, str | None) else known(figure.document, DIGITS),
        'shape': _bounds(figure.shape),
        'near': _bounds(figure.near),
    }


def _bounds(bounds: Bounds | None) -> list[float | None] | None:
    return None if bounds is None else [None if bound is None else known(bound, DIGITS) for bound in bounds]


def plain_plot(plot: Plot) -> Json:
    """A plot as JSON."""
    return {**plot._asdict(), 'series': [_series(series) for series in plot.series]}


def _series(series: Series) -> Json:
    def short(values: Sequence[Any]) -> list[Any]:
        return [v if isinstance(v, str) else known(v, DRAWN) for v in values]

    return {
        'name': series.name,
        'style': series.style,
        **{name: short(getattr(series, name)) for name in ('x', 'y', 'low', 'high')},
    }

"""A claim whose figures are all there is to see: ours with intervals, the document's, and where rules want them."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from wsn_tracking.evaluation import plot_style as style
from wsn_tracking.reproduction.drawings import as_svg
from wsn_tracking.reproduction.verdicts import judged

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Json = Mapping[str, Any]
MOST = 12  # rows; of a claim with more figures those with a rule or a document's number are shown
WIDE = 10.0  # an axis of figures further apart than this is logarithmic
LABEL = 36  # letters in a line of a row's name
SHAPE, NEAR, HOLDS, OPEN, FAILS = '#dcefe1', '#a9d8b5', style.COLOURS[0], style.COLOURS[4], style.COLOURS[1]
INKS = {'holds': HOLDS, 'open': OPEN, 'fails': FAILS}


def forest(claim: Json) -> bytes:
    """Figures of a claim of the JSON as SVG: a row a figure, a panel a unit."""
    rows = shown(claim['figures'])
    units = list(dict.fromkeys(row['unit'] for row in rows))
    groups = [[row for row in rows if row['unit'] == unit] for unit in units]
    figure = style.new_figure(6.4, 0.9 + 0.42 * len(rows) + 0.35 * len(groups))
    panels = figure.subplots(len(groups), 1, squeeze=False, height_ratios=[len(group) for group in groups])[:, 0]
    for axes, unit, group in zip(panels, units, groups, strict=True):
        style.dress(axes)
        _panel(axes, group)
        axes.set_xlabel(unit)
    style.legend_outside(figure, [*_legend(rows)], 'outside lower center')
    return as_svg(figure)


def shown(figures: Sequence[Json]) -> list[Json]:
    """Those that are drawn: all, or those that there is something to be compared with, and at most MOST."""
    known = [f for f in figures if f['value'] is not None and None not in f['interval_95']]
    compared = [f for f in known if f['shape'] or f['near'] or isinstance(f['document'], float)]
    return (known if len(known) <= MOST else compared)[:MOST]


def _panel(axes: Axes, rows: Sequence[Json]) -> None:
    low, high, log = _ends(rows)
    if log:
        axes.set_xscale('log')
    axes.set_xlim(low, high)
    for y, row in enumerate(rows):
        for kind, colour, half in (('shape', SHAPE, 0.4), ('near', NEAR, 0.28)):
            if row[kind]:
                left, right = (
                    end if bound is None else bound for bound, end in zip(row[kind], (low, high), strict=True)
                )
                axes.fill_betweenx([y - half, y + half], left, right, color=colour, linewidth=0, zorder=1)
        ink = INKS[_found(row)]
        axes.plot(row['interval_95'], [y, y], color=ink, linewidth=2.0, zorder=3)
        axes.plot([row['value']], [y], 'o', color=ink, markersize=4.0, zorder=3)
        if isinstance(row['document'], float):
            axes.plot([row['document']], [y], 'D', color=style.INK, markerfacecolor='none', markersize=5.5, zorder=4)
    axes.set_ylim(len(rows) - 0.5, -0.5)
    axes.set_yticks(range(len(rows)), [textwrap.fill(row['name'], LABEL) for row in rows])


def _found(row: Json) -> str:
    """The worst that becomes of the rules of a figure; without any it holds."""
    found = {judged(row['interval_95'], row[kind]) for kind in ('shape', 'near') if row[kind]}
    return next((word for word in ('fails', 'open') if word in found), 'holds')


def _ends(rows: Sequence[Json]) -> tuple[float, float, bool]:
    """Lowest and highest of an axis, and whether it is logarithmic."""
    ours = [float(v) for row in rows for v in (row['value'], *row['interval_95'])]
    told = [row['document'] for row in rows if isinstance(row['document'], float)]
    bounds = [float(b) for row in rows for kind in ('shape', 'near') for b in row[kind] or () if b is not None]
    values = [*ours, *told, *bounds]
    low, high = min(values), max(values)
    if low > 0.0 and high > WIDE * low:
        room = 0.06 * math.log(high / low)
        return low * math.exp(-room), high * math.exp(room), True
    room = 0.06 * (high - low) or 0.05 * abs(high) or 1.0
    return low - room, high + room, False


def _legend(rows: Sequence[Json]) -> Iterator[Any]:
    """What the marks are, of those that there are."""
    yield style.line_handle('ours, 95 % interval', color=HOLDS, marker='o', markersize=4.0)
    found = {_found(row) for row in rows}
    for word, text in (('open', 'undecided'), ('fails', 'outside of a rule')):
        if word in found:
            yield style.line_handle(text, color=INKS[word], marker='o', markersize=4.0)
    if any(isinstance(row['document'], float) for row in rows):
        yield style.line_handle(
            'document', color=style.INK, marker='D', linestyle='', markerfacecolor='none', markersize=5.5
        )
    near = any(row['near'] for row in rows)
    if any(row['shape'] for row in rows):
        yield style.patch_handle('rule on the shape' if near else 'rule', color=SHAPE)
    if near:
        yield style.patch_handle('rule on the number', color=NEAR)

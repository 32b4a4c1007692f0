"""Error and NEES of every output over time, one panel an output so that none hides another."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wsn_tracking.evaluation import plot_style as style
from wsn_tracking.evaluation.consistency import nees_interval
from wsn_tracking.evaluation.score import SKIP_S, Matched, match, score
from wsn_tracking.models.anchors import Floats
from wsn_tracking.sensing.recording import Truth
from wsn_tracking.trackers.estimate import Estimate

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.patches import Patch

NEES_TOP = 15.0  # of the axis: twice the single-epoch bound; what is above is marked at the edge
LONG_DASH = (0, (4, 3))


def plot_errors(
    path: str | Path,
    truths: Mapping[int, Truth],
    estimates: Mapping[str, Sequence[Estimate]],
    *,
    start_ns: int | None = None,
    skip_s: float = SKIP_S,
    title: str = 'Position error',
) -> None:
    """Error in x and in y over time, a row an output, with its band of three standard deviations, as PNG."""
    pens = style.pens(estimates)
    series = {name: match(estimates[name], _truth(truths, estimates[name])) for name in pens}
    start = _start(series, start_ns)
    reach = _reach(series, start, skip_s)
    figure = style.new_figure(9.0, 1.5 * max(1, len(series)) + 1.1)
    grid = figure.subplots(max(1, len(series)), 2, sharex=True, sharey=True, squeeze=False)
    for row, (name, matched) in zip(grid, series.items(), strict=False):
        t = _seconds(matched.stamps_ns, start)
        with np.errstate(invalid='ignore'):
            sigma = np.sqrt(np.diagonal(matched.covariances, axis1=-2, axis2=-1))
        for axis, axes in enumerate(row):
            style.dress(axes)
            _shade_skipped(axes, skip_s)
            axes.axhline(0.0, color=style.MUTED, linewidth=0.7)
            band = 3.0 * sigma[:, axis]
            axes.fill_between(t, -band, band, color=pens[name].color, alpha=0.18, linewidth=0.0)
            axes.plot(t, matched.errors[:, axis], color=pens[name].color, linewidth=1.1)
            axes.set_ylim(-reach, reach)
        unknown = not np.any(np.isfinite(sigma))
        _name(row[0], name + (' (no covariance)' if unknown else ''))
        row[0].set_ylabel('error [m]')
    for axes, axis_name in zip(grid[0], 'xy', strict=True):
        axes.set_title(axis_name, fontsize=10, color=style.INK, loc='right')
    for axes in grid[-1]:
        axes.set_xlabel('time since the start [s]')
    style.heading(figure, title, len(pens), len(estimates))
    handles = [
        style.line_handle('estimate minus truth', color=style.MUTED, linewidth=1.1),
        style.patch_handle('three standard deviations', color=style.MUTED, alpha=0.25),
    ]
    style.legend_outside(figure, [*handles, *_skipped_handle(skip_s)], 'outside lower center')
    style.save(figure, path)


def plot_nees(
    path: str | Path,
    truths: Mapping[int, Truth],
    estimates: Mapping[str, Sequence[Estimate]],
    *,
    start_ns: int | None = None,
    skip_s: float = SKIP_S,
    title: str = 'NEES of the position',
) -> None:
    """NEES of every epoch, a panel an output, its mean and the mean's 95 % interval, to a PNG.

    Outputs without a covariance have no NEES: the title names them.
    """
    pens = style.pens(estimates)
    every = {name: match(estimates[name], _truth(truths, estimates[name])) for name in pens}
    start = _start(every, start_ns)
    series = {name: matched for name, matched in every.items() if np.any(np.isfinite(matched.nees))}
    silent = [name for name in every if name not in series]
    columns = 2 if len(series) > 1 else 1
    rows = max(1, -(-len(series) // columns))
    figure = style.new_figure(9.0, 1.8 * rows + 1.2)
    grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    _, bound = nees_interval(1.0)
    for axes in grid.flat[len(series) :]:
        axes.set_visible(False)
    for axes, (name, matched) in zip(grid.flat, series.items(), strict=False):
        style.dress(axes)
        _shade_skipped(axes, skip_s)
        result = score(estimates[name], _truth(truths, estimates[name]), skip_s, start_ns=start)
        t, color = _seconds(matched.stamps_ns, start), pens[name].color
        low, high = result.nees_interval
        axes.axhspan(low, high, color=style.MUTED, alpha=0.28, linewidth=0.0)
        axes.axhline(2.0, color=style.INK, linewidth=0.9)
        axes.axhline(bound, color=style.INK, linewidth=0.8, linestyle=LONG_DASH)
        axes.plot(t, matched.nees, color=color, linewidth=0.7, alpha=0.5)
        inside = np.where(matched.nees <= NEES_TOP, matched.nees, np.nan)
        axes.plot(t, inside, '.', color=color, markersize=3.5)
        above = t[matched.nees > NEES_TOP]
        axes.plot(above, np.full(above.shape, 0.97 * NEES_TOP), '^', color=color, markersize=4.5)
        axes.axhline(min(result.nees, NEES_TOP), color=color, linewidth=1.8)
        place = 'in' if low <= result.nees <= high else 'outside'
        _name(axes, f'{name}   mean {result.nees:.2f} {place} [{low:.2f}, {high:.2f}]')
        axes.set_ylim(0.0, NEES_TOP)
    for axes in grid[:, 0]:
        axes.set_ylabel('NEES')
    for axes in grid.flat[max(0, len(series) - columns) :]:
        axes.set_xlabel('time since the start [s]')
        axes.tick_params(labelbottom=True)
    remark = f'; without covariance: {", ".join(silent)}' if silent else ''
    style.heading(figure, title, len(pens), len(estimates), remark)
    handles = [
        style.line_handle('mean', color=style.MUTED, linewidth=1.8),
        style.patch_handle('95 % interval of the mean', color=style.MUTED, alpha=0.28),
        style.line_handle('expected: 2', color=style.INK, linewidth=0.9),
        style.line_handle('97.5 % of single epochs', color=style.INK, linewidth=0.8, linestyle=LONG_DASH),
        style.line_handle('beyond the axis', color=style.MUTED, marker='^', linestyle='none', markersize=4.5),
        *_skipped_handle(skip_s),
    ]
    style.legend_outside(figure, handles, 'outside lower center')
    style.save(figure, path)


def _truth(truths: Mapping[int, Truth], estimates: Sequence[Estimate]) -> Truth:
    """Of the target that an output speaks of; where it has said nothing yet, anybody's."""
    return truths[estimates[0].target_id] if estimates else next(iter(truths.values()))


def _start(series: Mapping[str, Matched], start_ns: int | None) -> int:
    first = [int(m.stamps_ns[0]) for m in series.values() if m.stamps_ns.size]
    return start_ns if start_ns is not None else min(first, default=0)


def _seconds(stamps_ns: NDArray[np.int64], start_ns: int) -> Floats:
    return np.asarray((stamps_ns - start_ns) * 1e-9)


def _reach(series: Mapping[str, Matched], start_ns: int, skip_s: float) -> float:
    """Half the height of the error axes: holds 99 % of the settled errors, and usual bands."""
    wanted = [0.05]
    for matched in series.values():
        settled = _seconds(matched.stamps_ns, start_ns) >= skip_s
        errors = np.abs(matched.errors[settled])
        errors = errors[np.isfinite(errors)]
        variances = np.diagonal(matched.covariances[settled], axis1=-2, axis2=-1)
        variances = variances[np.isfinite(variances) & (variances > 0.0)]
        if errors.size:
            wanted.append(1.15 * float(np.percentile(errors, 99.0)))
        if variances.size:
            wanted.append(3.6 * float(np.sqrt(np.median(variances))))
    return max(wanted)


def _shade_skipped(axes: Axes, skip_s: float) -> None:
    if 0.0 < skip_s < np.inf:
        axes.axvspan(0.0, skip_s, color='#f1f1f1', zorder=0, linewidth=0.0)


def _skipped_handle(skip_s: float) -> list[Patch]:
    return [style.patch_handle('not scored', color=style.FAINT)] if 0.0 < skip_s < np.inf else []


def _name(axes: Axes, text: str) -> None:
    """The panel's output, above its left corner: never on the data."""
    axes.set_title(text, loc='left', fontsize=8.5, color=style.INK)

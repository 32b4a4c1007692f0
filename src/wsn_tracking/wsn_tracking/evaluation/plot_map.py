"""The map: where the target was, where the outputs say it was, and how sure they are."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation import plot_style as style
from wsn_tracking.evaluation.ellipses import ellipse, known
from wsn_tracking.models.anchors import Anchors, Floats
from wsn_tracking.sensing.recording import Truth
from wsn_tracking.trackers.estimate import Estimate, Kind

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

ELLIPSES = 14  # along a track: more would hide it
PALE = '#c4c4c4'
MOST_IDS = 60  # more numbers than this cover each other
Area = tuple[float, float, float, float]  # x_min, y_min, x_max, y_max [m]


def plot_map(
    path: str | Path,
    anchors: Anchors,
    truths: Mapping[int, Truth],
    estimates: Mapping[str, Sequence[Estimate]],
    area: Area | None = None,
    *,
    title: str = 'Map',
    ellipses_of: str | None = None,
) -> None:
    """Draw the anchors, the truth, every output's track and the 95 % ellipses of one output to a PNG.

    Of several targets the colour of a track tells the time: who was where at once; of each one output is drawn so, and
    none before its target was found.
    ellipses_of: that output; by default the first fused one, else the first, whose covariance is known.
    """
    if ellipses_of is not None and ellipses_of not in estimates:
        raise TrackingError(f'no output {ellipses_of}: ellipses can be drawn of {", ".join(estimates)}')
    pens = style.pens(estimates)
    chosen = ellipses_of if ellipses_of is not None else _trusted({n: estimates[n] for n in pens})
    x_min, y_min, x_max, y_max = box = _frame(anchors, truths.values(), area)
    shape = (y_max - y_min) / (x_max - x_min)
    width = 5.8 if shape < 1.2 else 5.8 * 1.2 / shape
    figure = style.new_figure(width + 2.4, width * shape + 1.2)
    axes = figure.add_subplot()
    style.dress(axes)
    handles: list[Line2D] = []
    if area is not None:
        corners = np.asarray(area)[np.array([[0, 1], [2, 1], [2, 3], [0, 3], [0, 1]])]
        axes.plot(*corners.T, color='#b0b0b0', linewidth=1.0, zorder=1)
    timed = _timed(estimates)
    wide: dict[str, Any] = {'linewidth': 2.2, 'color': style.INK} if not timed else {'linewidth': 4.5, 'color': PALE}
    for number, truth in enumerate(truths.values()):
        handles += axes.plot(*_way(truth).T, zorder=3, label='truth', **wide)[: number == 0]
    starts = np.array([_way(truth)[_recorded(truth)][0] for truth in truths.values() if _recorded(truth).any()])
    if starts.size:
        handles += axes.plot(*starts.T, 'o', color='white', mec=style.INK, zorder=6, label='start')
    for name, pen in pens.items():
        track = _track(estimates[name])
        if name in timed:
            handles += axes.plot(
                *track[-1:].T, 'o', color=pen.color, mec='white', zorder=6, label=f'{name}, at the end'
            )
        else:
            weight = {'linewidth': 1.8, 'zorder': 5} if name == chosen else {'linewidth': 0.9, 'alpha': 0.6}
            handles += axes.plot(*track.T, label=name, **{'zorder': 4, **weight, **pen._asdict()})
    if timed:
        _draw_by_time(figure, axes, [estimates[name] for name in timed if name in pens])
    if chosen is not None:
        color = pens[chosen].color if chosen in pens else style.MUTED
        label = f'95 % of {chosen}'
        handles += axes.plot(*_rings(estimates[chosen]).T, color=color, linewidth=0.8, zorder=2, label=label)
    handles.append(_draw_anchors(axes, anchors))
    axes.set(xlim=box[::2], ylim=box[1::2], xlabel='x [m]', ylabel='y [m]')
    axes.set_aspect('equal', adjustable='box')
    style.heading(figure, title, len(pens), len(estimates))
    style.legend_outside(figure, handles)
    style.save(figure, path)


def _timed(estimates: Mapping[str, Sequence[Estimate]]) -> tuple[str, ...]:
    """The first output of each of several targets; of one target none."""
    first: dict[int, str] = {}
    for name, track in estimates.items():
        if track:
            first.setdefault(track[0].target_id, name)
    return tuple(first.values()) if len(first) > 1 else ()


def _draw_by_time(figure: Figure, axes: Axes, tracks: Sequence[Sequence[Estimate]]) -> None:
    """Tracks coloured by the time since the first epoch of all."""
    from matplotlib.collections import LineCollection

    ways = [_track(track) for track in tracks]
    stamps = [np.array([e.stamp_ns for e in track]) for track in tracks]
    first = min(int(times.min()) for times in stamps)
    segments = np.concatenate([np.stack([way[:-1], way[1:]], axis=1) for way in ways])
    seconds = np.concatenate([(times[1:] - first) * 1e-9 for times in stamps])
    lines = LineCollection([*segments], array=seconds, cmap='viridis', linewidth=1.6, zorder=5)
    axes.add_collection(lines, autolim=False)
    figure.colorbar(lines, ax=axes, label='time [s]', shrink=0.7)


def _track(estimates: Sequence[Estimate]) -> Floats:
    """Positions (K, 2) [m]; NaN while the target is still looked for."""
    places = [e.mean[:2] if e.kind != Kind.START else (np.nan, np.nan) for e in estimates]
    return np.array(places, dtype=np.float64).reshape(-1, 2)


def _way(truth: Truth) -> Floats:
    return truth.positions[:, :2]


def _draw_anchors(axes: Axes, anchors: Anchors) -> Line2D:
    places = anchors.positions[:, :2]
    (handle,) = axes.plot(*places.T, '^', color=style.MUTED, markersize=6, zorder=4, label='node')
    if anchors.ids.size <= MOST_IDS:
        looks: dict[str, Any] = {'ha': 'center', 'fontsize': 7, 'color': style.MUTED, 'zorder': 4}
        for node, place in zip(anchors.ids, places, strict=True):
            axes.annotate(str(node), place, (0, 5), textcoords='offset points', **looks)
    return handle


def _recorded(truth: Truth) -> NDArray[np.bool_]:
    return np.asarray(np.all(np.isfinite(truth.positions), axis=-1))


def _frame(anchors: Anchors, truths: Iterable[Truth], area: Area | None) -> Area:
    """What must be seen, with a margin: a lost track may leave the picture, it must not shrink the room."""
    points = [anchors.positions[:, :2], *(_way(truth)[_recorded(truth)] for truth in truths)]
    if area is not None:
        points.append(np.asarray(area, dtype=np.float64).reshape(2, 2))
    every = np.concatenate(points)
    low, high = every.min(axis=0), every.max(axis=0)
    margin = 0.07 * max(float(np.max(high - low)), 0.5)
    return float(low[0] - margin), float(low[1] - margin), float(high[0] + margin), float(high[1] + margin)


def _rings(estimates: Sequence[Estimate]) -> Floats:
    """Ellipses at equal intervals as one line, (points, 2) [m], with NaN between them.

    The first comes half an interval late: the very start is all uncertainty.
    """
    means, covariances = known(estimates)
    step = max(1, round(len(means) / ELLIPSES))
    rings = ellipse(means[step // 2 :: step], covariances[step // 2 :: step])
    gaps = np.full((rings.shape[0], 1, 2), np.nan)
    return np.concatenate([rings, gaps], axis=1).reshape(-1, 2)


def _trusted(estimates: Mapping[str, Sequence[Estimate]]) -> str | None:
    """The output whose ellipses are worth drawing."""
    sure = [name for name, track in estimates.items() if known(track)[0].size]
    fused = [name for name in sure if estimates[name][-1].kind == Kind.FUSED]
    return next(iter([*fused, *sure]), None)

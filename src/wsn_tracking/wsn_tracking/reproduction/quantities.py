"""From runs to figures and curves, each with its 95 % interval."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from wsn_tracking.models.anchors import Floats
from wsn_tracking.reproduction.claims import Bounds, Figure, Series
from wsn_tracking.studies.intervals import NORMAL_95, change_of, mean_of, ratio_of
from wsn_tracking.studies.intervals import Figure as Interval

RESAMPLED = 500  # sets of runs of a bootstrap


def mean(
    name: str,
    values: Floats,
    unit: str = '',
    scale: float = 1.0,
    *,
    document: float | str | None = None,
    shape: Bounds | None = None,
    near: Bounds | None = None,
) -> Figure:
    """Mean over runs (R,), times `scale`."""
    return Figure(name, mean_of(values, scale), unit, document, shape, near)


def ratio(
    name: str,
    above: Floats,
    below: Floats,
    root: bool = False,
    *,
    document: float | str | None = None,
    shape: Bounds | None = None,
    near: Bounds | None = None,
) -> Figure:
    """Ratio of two means of the same runs (R,), or of their roots."""
    return Figure(name, ratio_of(above, below, root), '', document, shape, near)


def change(
    name: str,
    value: Floats,
    base: Floats,
    *,
    document: float | str | None = None,
    shape: Bounds | None = None,
    near: Bounds | None = None,
) -> Figure:
    """How far one mean lies above another of the same runs, in percent."""
    return Figure(name, change_of(value, base), '%', document, shape, near)


def root_mean(
    name: str,
    squares: Floats,
    unit: str = '',
    scale: float = 1.0,
    *,
    document: float | str | None = None,
    shape: Bounds | None = None,
    near: Bounds | None = None,
) -> Figure:
    """Root of the mean over runs (R,), times `scale`."""
    return Figure(name, ratio_of(scale**2 * squares, np.ones_like(squares), root=True), unit, document, shape, near)


def curve(name: str, x: Sequence[float], values: Floats, root: bool = False, scale: float = 1.0) -> Series:
    """Mean over the runs of (R, K) against x (K,), with its interval; `root`: the root of the mean."""
    m = values.mean(axis=0)
    half = NORMAL_95 * values.std(axis=0, ddof=1) / np.sqrt(len(values)) if len(values) > 1 else np.zeros_like(m)
    low, high = m - half, m + half
    if root:
        m, low, high = (np.sqrt(np.maximum(v, 0.0)) for v in (m, low, high))
    return Series(name, list(x), *((scale * v).tolist() for v in (m, low, high)))


def bars(name: str, figures: Sequence[tuple[str | float, Figure]]) -> Series:
    """A row of bars: a label and the figure it shows. With numbers as labels they make a line."""
    ends = np.array([figure.ours['interval_95'] for _, figure in figures], dtype=np.float64)
    values = [float(np.asarray(figure.ours['value'])) for _, figure in figures]
    return Series(name, [label for label, _ in figures], values, ends[:, 0].tolist(), ends[:, 1].tolist())


def path(name: str, xy: Floats, style: str = 'line') -> Series:
    """A track (K, 2) [m] on a map."""
    return Series(name, xy[:, 0].tolist(), xy[:, 1].tolist(), style=style)


def median(
    name: str, values: Floats, unit: str = '', *, shape: Bounds | None = None, document: float | str | None = None
) -> Figure:
    """Median over runs (R,); its interval lies between the runs that the binomial distribution names."""
    ordered = np.sort(values)
    count = len(ordered)
    half = 0.5 * NORMAL_95 * np.sqrt(count)
    low = ordered[max(int(np.floor(0.5 * count - half)), 0)]
    high = ordered[min(int(np.ceil(0.5 * count + half)), count - 1)]
    ours: Interval = {'value': float(np.median(ordered)), 'interval_95': [float(low), float(high)]}
    return Figure(name, ours, unit, document, shape)


def bootstrapped(
    name: str,
    statistic: Callable[[Sequence[Floats]], float],
    values: Sequence[Floats],
    unit: str = '',
    *,
    document: float | str | None = None,
    shape: Bounds | None = None,
    near: Bounds | None = None,
) -> Figure:
    """A statistic of means over runs: values (R, ...) each of the same runs, `statistic` takes their means.

    Its interval is that of runs drawn anew from the runs, with replacement (Efron 1979, percentiles).
    """
    count = len(values[0])
    generator = np.random.default_rng(count)  # equal runs have equal intervals
    weights = generator.multinomial(count, np.full(count, 1.0 / count), RESAMPLED) / count
    drawn = [np.tensordot(weights, v, axes=1) for v in values]
    found = np.array([statistic([d[i] for d in drawn]) for i in range(RESAMPLED)])
    low, high = np.quantile(found, [0.025, 0.975])
    ours: Interval = {'value': statistic([v.mean(axis=0) for v in values]), 'interval_95': [float(low), float(high)]}
    return Figure(name, ours, unit, document, shape, near)

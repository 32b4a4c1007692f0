"""What of one track or trail is on the live map: a line that fades with age, its head, its ellipses."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wsn_tracking.evaluation import plot_style as style
from wsn_tracking.evaluation.ellipses import ellipse, known
from wsn_tracking.models.anchors import Floats
from wsn_tracking.viewing.node_states import rgb
from wsn_tracking.viewing.scene import Track, Trail

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FAINTEST = 0.08  # strength of what is almost as old as the window
PAST_ELLIPSES = 8  # about so many along a full track
BREAK = 8.0  # times as long as is usual between two stamps: nobody knows where the target went meanwhile
Rgba = tuple[float, float, float, float]


class LiveTrail:
    """The truth of one target."""

    def __init__(self, axes: Axes) -> None:
        from matplotlib.collections import LineCollection

        self._line = LineCollection([], linewidths=2.4, zorder=3, capstyle='round')
        axes.add_collection(self._line, autolim=False)
        (self._head,) = axes.plot([], [], 'o', color='white', markeredgecolor=style.INK, markersize=8, mew=2, zorder=7)

    def draw(self, trail: Trail, now: int, window: float) -> None:
        """Show it as of `now`, where what is older than `window` [ns] has gone."""
        known = unbroken(trail.stamps_ns)
        self._line.set_segments([piece for piece, drawn in zip(segments(trail.positions), known, strict=True) if drawn])
        self._line.set_color(faded(style.INK, trail.stamps_ns[1:][known], now, window))
        self._head.set_data(*trail.positions[-1:].T)


class LiveTrack:
    """One output's track, its latest ellipse, and some of those before."""

    def __init__(self, axes: Axes, color: str) -> None:
        from matplotlib.collections import LineCollection, PolyCollection

        self.color = color
        self._line = LineCollection([], linewidths=1.9, zorder=5, capstyle='round')
        self._rings = LineCollection([], linewidths=0.9, zorder=2)
        self._ellipse = PolyCollection(
            [], facecolors=(*rgb(color), 0.16), edgecolors=(*rgb(color), 0.9), linewidths=1.3, zorder=4
        )
        for collection in (self._line, self._rings, self._ellipse):
            axes.add_collection(collection, autolim=False)
        (self._head,) = axes.plot([], [], 'o', color=color, markeredgecolor='white', markersize=8, mew=1.2, zorder=8)

    def set_visible(self, visible: bool) -> None:
        """Show or hide all of it."""
        for artist in (self._line, self._rings, self._ellipse, self._head):
            artist.set_visible(visible)

    def draw(self, track: Track, now: int, window: float) -> None:
        """Show it as of `now`, where what is older than `window` [ns] has gone."""
        estimates = track.estimates
        places = np.array([e.mean[:2] for e in estimates])
        stamps = np.array([e.stamp_ns for e in estimates])
        self._line.set_segments(segments(places))
        self._line.set_color(faded(self.color, stamps[1:], now, window))
        self._head.set_data(*places[-1:].T)
        means, covariances = known(estimates[-1:])
        self._ellipse.set_verts(list(ellipse(means, covariances)))
        # chosen by number, so that a ring stays where it is until it has faded
        step = max(1, track_step(estimates[-1].request_seq - estimates[0].request_seq))
        past = [e for e in estimates[:-1] if e.request_seq % step == 0 and known([e])[0].size]
        self._rings.set_segments(list(ellipse(*known(past))))
        self._rings.set_color(faded(self.color, np.array([e.stamp_ns for e in past]), now, window, 0.5))


def track_step(epochs: int) -> int:
    """Epochs between two rings: a power of two, so that a longer track keeps every second one."""
    return 1 << max(0, (epochs // PAST_ELLIPSES).bit_length() - 1)


def unbroken(stamps_ns: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Which of the M - 1 pieces between M stamps are no gaps: whoever only looks on may miss samples of the truth."""
    steps = np.diff(stamps_ns)
    return np.asarray(steps <= BREAK * np.median(steps)) if steps.size else np.zeros(0, dtype=np.bool_)


def segments(places: Floats) -> list[Floats]:
    """A line (M, 2) as M - 1 lines (2, 2), each of which can have its own colour."""
    return list(np.stack([places[:-1], places[1:]], axis=1))


def faded(color: str, stamps_ns: NDArray[np.int64], now: int, window: float, opacity: float = 1.0) -> list[Rgba]:
    """Red, green, blue, opacity of each stamp, (K,) -> K: full at `now`, gone from `window` [ns] on.

    Most of it is a paler colour, not a lower opacity: half-transparent pieces of a line would show their joints.
    """
    age = np.clip((now - stamps_ns) / window, 0.0, 1.0)
    strength = np.where(age < 1.0, 1.0 - (1.0 - FAINTEST) * age, 0.0)
    pale = 1.0 - strength[:, None] * (1.0 - np.array(rgb(color)))
    rows = np.column_stack([pale, opacity * np.minimum(1.0, 4.0 * strength)])
    return [(r, g, b, a) for r, g, b, a in rows.tolist()]

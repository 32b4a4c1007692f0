"""The map of a scene while it happens: artists are made once and moved, so that a redraw is cheap."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime, timezone
from typing import TYPE_CHECKING, Any

import numpy as np

from wsn_tracking.evaluation import plot_style as style
from wsn_tracking.evaluation.plot_map import MOST_IDS
from wsn_tracking.models.anchors import Anchors, Floats
from wsn_tracking.viewing.live_legend import Legends
from wsn_tracking.viewing.live_track import LiveTrack, LiveTrail
from wsn_tracking.viewing.node_states import look
from wsn_tracking.viewing.scene import Scene, Track, Trail

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIZE = (9.6, 6.4)  # [inches]
DPI = 110
MARGIN = 0.08  # of the extent of what is seen
SIDE = 0.765  # where the column with the legends begins, as a share of the width
NO_DATA = 'no data yet'


def new_live_figure() -> Figure:
    """An empty figure without a window."""
    return style.new_figure(*SIZE, dpi=DPI, layout=None)


class LiveMap:
    """Draws a scene into a figure, again and again."""

    def __init__(self, figure: Figure, title: str = '') -> None:
        from matplotlib.collections import LineCollection

        self._figure = figure
        self._axes = figure.add_axes((0.065, 0.085, SIDE - 0.095, 0.81))
        style.dress(self._axes)
        self._axes.set(xlabel='x [m]', ylabel='y [m]')
        self._axes.set_aspect('equal')
        self._axes.set_visible(False)
        figure.text(0.02, 0.975, title, fontsize=12, color=style.INK, va='top')
        self._clock = figure.text(0.02, 0.937, '', fontsize=8.5, color=style.MUTED, va='top')
        self._warning = figure.text(SIDE, 0.975, '', fontsize=9.5, color=style.COLOURS[1], va='top')
        self._empty = figure.text(0.5 * SIDE, 0.5, NO_DATA, fontsize=15, color=style.MUTED, ha='center', va='center')
        self._nodes = self._axes.scatter([], [], s=60, marker='^', edgecolors=style.MUTED, linewidths=0.8, zorder=4)
        self._links = LineCollection([], colors=look(0).color, linewidths=0.8, alpha=0.45, zorder=2)
        self._axes.add_collection(self._links, autolim=False)
        self._ids: list[Any] = []
        self._anchors: Anchors | None = None
        self._box = (np.full(2, np.inf), np.full(2, -np.inf))
        self._tracks: dict[tuple[str, int], LiveTrack] = {}
        self._trails: dict[int, LiveTrail] = {}
        self._legends = Legends(figure, SIDE)

    def draw(self, scene: Scene, warning: str = '') -> None:
        """Show a scene as it is now; `warning` is a line above the legends."""
        newest, window = scene.newest, max(scene.window_ns, 1.0)
        tracks, trails = scene.tracks, scene.trails
        now = max([e.stamp_ns for e in (newest,) if e is not None] + [int(t.stamps_ns[-1]) for t in trails], default=0)
        self._warning.set_text(warning)
        self._empty.set_visible(not (tracks or trails or scene.node_states))
        self._clock.set_text('' if newest is None else f'epoch {newest.request_seq}   {_utc(newest.stamp_ns)}')
        self._show_nodes(scene)
        self._show_links(scene, tracks)
        for trail in trails:
            if trail.target_id not in self._trails:
                self._trails[trail.target_id] = LiveTrail(self._axes)
            self._trails[trail.target_id].draw(trail, now, window)
        self._show_tracks(tracks, now, window)
        self._fit(scene.anchors, tracks, trails)
        colors = {key: shown.color for key, shown in self._tracks.items()}
        self._legends.draw(scene.node_states, tracks, trails, colors)

    # ---- within

    def _show_nodes(self, scene: Scene) -> None:
        if scene.anchors is None:
            return
        places, states = scene.anchors.positions[:, :2], scene.node_states
        seen = [look(states.get(node)) for node in scene.anchors.ids.tolist()]
        self._nodes.set_offsets(places)
        self._nodes.set_facecolor([one.color for one in seen])
        self._nodes.set_sizes([110.0 if states.get(node) == 0 else 60.0 for node in scene.anchors.ids.tolist()])
        if scene.anchors is self._anchors:
            return
        self._anchors = scene.anchors
        for text in self._ids:
            text.remove()
        shown = zip(scene.anchors.ids.tolist(), places, strict=True) if len(places) <= MOST_IDS else ()
        words: dict[str, Any] = {'ha': 'center', 'fontsize': 7.5, 'color': style.MUTED, 'zorder': 4}
        self._ids = [
            self._axes.annotate(str(node), (x, y), (0, 7), textcoords='offset points', **words)
            for node, (x, y) in shown
        ]

    def _show_links(self, scene: Scene, tracks: Sequence[Track]) -> None:
        """From each estimate to the nodes whose measurements it used; one output a target."""
        lines: list[Floats] = []
        if scene.anchors is not None:
            for track in {track.target_id: track for track in reversed(tracks)}.values():
                last = track.estimates[-1]
                rows = scene.anchors.rows(last.measurements)
                lines += [np.array([scene.anchors.positions[row, :2], last.mean[:2]]) for row in rows[rows >= 0]]
        self._links.set_segments(lines)

    def _show_tracks(self, tracks: Sequence[Track], now: int, window: float) -> None:
        for track in tracks:
            key = (track.name, track.target_id)
            if key not in self._tracks:
                color = style.COLOURS[len(self._tracks) % len(style.COLOURS)]
                self._tracks[key] = LiveTrack(self._axes, color)
            self._tracks[key].draw(track, now, window)
        there = {(track.name, track.target_id) for track in tracks}
        for key, shown in self._tracks.items():
            shown.set_visible(key in there)

    def _fit(self, anchors: Anchors | None, tracks: Sequence[Track], trails: Sequence[Trail]) -> None:
        """Show the nodes and the truth; the view only grows, and a lost track does not shrink the room."""
        places = [] if anchors is None else [anchors.positions[:, :2]]
        places += [trail.positions for trail in trails]
        if not places:
            places = [np.array([e.mean[:2] for e in track.estimates]) for track in tracks]
        if not places:
            return
        every = np.concatenate(places)
        low, high = np.minimum(self._box[0], every.min(axis=0)), np.maximum(self._box[1], every.max(axis=0))
        if np.array_equal(low, self._box[0]) and np.array_equal(high, self._box[1]):
            return
        self._box = (low, high)
        extent = high - low + 2.0 * MARGIN * max(float(np.max(high - low)), 0.5)
        frame = self._figure.get_size_inches() * self._axes.get_position(original=True).size
        half = 0.5 * frame * float(np.max(extent / frame))  # as much more of the shorter side as fills the frame
        centre = 0.5 * (low + high)
        (left, bottom), (right, top) = (centre - half).tolist(), (centre + half).tolist()
        self._axes.set(xlim=(left, right), ylim=(bottom, top))
        self._axes.set_visible(True)


def _utc(stamp_ns: int) -> str:
    try:
        return datetime.fromtimestamp(stamp_ns // 1_000_000_000, timezone.utc).strftime('%Y-%m-%d %H:%M:%S UTC')
    except (ValueError, OverflowError, OSError):  # a stamp that no calendar holds
        return f'{stamp_ns * 1e-9:.1f} s'

"""The column beside the live map: which line is which, how far off it is, what the nodes do."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from wsn_tracking.evaluation import plot_style as style
from wsn_tracking.viewing.node_states import look
from wsn_tracking.viewing.scene import Track, Trail

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.figure import Figure
    from matplotlib.legend import Legend

TOP, BOTTOM = 0.905, 0.085  # shares of the height


class Legends:
    """Two legends, made anew with each map: their numbers change."""

    def __init__(self, figure: Figure, left: float) -> None:
        self._figure, self._left = figure, left
        self._shown: list[Legend] = []

    def draw(
        self,
        states: Mapping[int, int],
        tracks: Sequence[Track],
        trails: Sequence[Trail],
        colors: Mapping[tuple[str, int], str],
    ) -> None:
        """Name the tracks and the truth; count the nodes by state."""
        for legend in self._shown:
            legend.remove()
        estimates = self._legend(_outputs(tracks, trails, colors), TOP, 'upper left', 'estimates')
        nodes = self._legend(_nodes(states), BOTTOM, 'lower left', 'nodes in this epoch')
        self._shown = [estimates, nodes]

    def _legend(self, handles: Sequence[Artist], height: float, corner: Any, title: str) -> Legend:
        legend = self._figure.legend(
            handles=handles,
            loc=corner,
            bbox_to_anchor=(self._left, height),
            borderaxespad=0.0,
            borderpad=0.0,
            labelspacing=0.55,
            frameon=False,
            fontsize=9,
            labelcolor=style.INK,
            title=title if handles else None,
            title_fontsize=9,
            alignment='left',
        )
        legend.get_title().set_color(style.MUTED)
        return legend


def label(track: Track, trail: Trail | None, *, several: bool) -> str:
    """An output in words: its name, its target where there are several, how far from the truth it is."""
    last = track.estimates[-1]
    name = f'{track.name} of {track.target_id}' if several and '_target_' not in track.name else track.name
    if trail is None or not trail.stamps_ns[0] <= last.stamp_ns <= trail.stamps_ns[-1]:
        return name
    seconds = (trail.stamps_ns - last.stamp_ns) * 1e-9
    truth = [np.interp(0.0, seconds, trail.positions[:, axis]) for axis in (0, 1)]
    return f'{name}   {np.hypot(*(last.mean[:2] - truth)):.2f} m off'


def _outputs(tracks: Sequence[Track], trails: Sequence[Trail], colors: Mapping[tuple[str, int], str]) -> list[Artist]:
    truth = {trail.target_id: trail for trail in trails}
    several = len({track.target_id for track in tracks} | truth.keys()) > 1
    handles: list[Artist] = []
    for track in tracks:
        words = label(track, truth.get(track.target_id), several=several)
        handles.append(style.line_handle(words, color=colors[track.name, track.target_id], linewidth=2.0))
    if trails:
        handles.append(style.line_handle('truth', color=style.INK, linewidth=2.4))
    if tracks:
        handles.append(style.patch_handle('95 % ellipse', color=style.MUTED, alpha=0.3))
    return handles


def _nodes(states: Mapping[int, int]) -> list[Artist]:
    every = list(states.values())
    spot = {'marker': '^', 'linestyle': 'none', 'markersize': 8, 'markeredgecolor': style.MUTED}
    return [
        style.line_handle(f'{every.count(state)} {look(state).words}', color=look(state).color, **spot)
        for state in sorted(set(every))
    ]

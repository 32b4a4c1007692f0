"""Where a live map is seen: a PNG file that is rewritten whole, or a window."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation import plot_style as style
from wsn_tracking.viewing.live_map import DPI, SIZE, LiveMap, new_live_figure
from wsn_tracking.viewing.scene import Scene

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Png:
    """A file; it is left alone while nothing has changed."""

    is_open = True
    breathe: Callable[[], None] | None = None

    def __init__(self, path: Path, title: str) -> None:
        self._path = path
        self._figure = new_live_figure()
        self._map = LiveMap(self._figure, title)
        self._shown: tuple[int, str] | None = None

    def show(self, scene: Scene, warning: str) -> None:
        """Rewrite the file; nobody ever reads half of it."""
        if self._shown == (scene.version, warning):
            return
        self._shown = (scene.version, warning)
        self._map.draw(scene, warning)
        style.save(self._figure, self._path)


class Window:
    """A window, until it is closed."""

    def __init__(self, title: str) -> None:
        self._figure = _open_figure(title)
        self._map = LiveMap(self._figure, title)
        self.is_open = True
        self._figure.canvas.mpl_connect('close_event', self._close)

    def show(self, scene: Scene, warning: str) -> None:
        """Draw anew."""
        self._map.draw(scene, warning)
        self._figure.canvas.draw_idle()

    def breathe(self) -> None:
        """Let the window answer its user."""
        self._figure.canvas.flush_events()

    def _close(self, _: object) -> None:
        self.is_open = False


def _open_figure(title: str) -> Figure:
    """A figure in a window; TrackingError where there is no display, or no toolkit that could use it."""
    try:
        from matplotlib import pyplot as plt

        figure = plt.figure(title, figsize=SIZE, dpi=DPI, facecolor='white')
        if figure.canvas.required_interactive_framework is not None:
            plt.show(block=False)
            return figure
        reason = 'there is no display'
    except Exception as error:  # noqa: BLE001 (each toolkit raises its own)
        reason = ' '.join(str(error).split())
    raise TrackingError(f'no window can be opened ({reason}): use --png FILE, or a display and python3-tk or Qt')

"""A matplotlib backend whose window is nowhere, and which its user closes after a while."""

from __future__ import annotations

import os

from matplotlib.backend_bases import CloseEvent, FigureManagerBase
from matplotlib.backends.backend_agg import FigureCanvasAgg


class FigureManager(FigureManagerBase):
    """A window."""

    def show(self):
        print('opened', flush=True)


class FigureCanvas(FigureCanvasAgg):
    """What is in it."""

    required_interactive_framework = 'headless'  # matplotlib refuses others where there is no display
    manager_class = FigureManager
    breaths = 0

    def draw_idle(self, *args, **kwargs):
        self.draw()
        print('drawn', flush=True)

    def flush_events(self):
        self.breaths += 1
        if self.breaths == int(os.environ['CLOSE_AFTER']):
            self.callbacks.process('close_event', CloseEvent('close_event', self))

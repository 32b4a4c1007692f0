"""`wsn-tracking watch` as a process, and the picture that it rewrites."""

from __future__ import annotations

import contextlib
import io
import subprocess
import sys

import numpy as np

from wsn_tracking.evaluation.plot_style import COLOURS
from wsn_tracking.viewing.node_states import LOOKS, rgb


class File:
    """A PNG that somebody rewrites: every version that was seen, each of them whole."""

    def __init__(self, path):
        self.path = path
        self.versions = {}

    def look(self):
        if self.path.exists():
            content = self.path.read_bytes()
            assert content.startswith(b'\x89PNG')
            assert content.endswith(b'IEND\xaeB`\x82')
            self.versions.setdefault(content, None)
        return list(self.versions)

    def shows_all(self):
        """Whether any version shows a track, the truth and nodes that did something in one and the same epoch."""
        for content in self.look():
            if self.versions[content] is None:
                self.versions[content] = (
                    coloured(content, COLOURS[0]) > 60
                    and coloured(content, '#222222') > 60
                    and sum(coloured(content, one.color) for one in LOOKS.values()) > 200
                )
        return any(self.versions.values())


@contextlib.contextmanager
def watching(environment, *arguments):
    """`wsn-tracking watch`, killed at the end if it still runs."""
    process = subprocess.Popen(
        [sys.executable, '-m', 'wsn_tracking.cli', 'watch', *arguments],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    try:
        yield process
    finally:
        process.kill()
        process.communicate()


def coloured(content, color):
    """Pixels of exactly that colour."""
    from matplotlib.image import imread

    pixels = np.round(imread(io.BytesIO(content))[..., :3] * 255)
    return int(np.sum(np.all(pixels == np.round(np.array(rgb(color)) * 255), axis=-1)))

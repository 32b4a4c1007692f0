"""`wsn-tracking watch` in a window, or without a display."""

from __future__ import annotations

import os

import live
from watching import watching


def without_display(environment):
    return {k: v for k, v in environment.items() if k not in {'DISPLAY', 'WAYLAND_DISPLAY', 'MPLBACKEND'}}


def test_without_a_display_watch_says_so_in_one_line():
    """Where matplotlib finds no toolkit by itself, and where it is told to use one that cannot open a window."""
    plain = without_display(os.environ)
    with watching(plain) as one, watching({**plain, 'MPLBACKEND': 'tkagg'}) as other:
        for process in (one, other):
            output, _ = process.communicate(timeout=live.TIMEOUT)
            assert process.returncode == 1
            (line,) = output.strip().splitlines()
            assert line.startswith('wsn-tracking watch: error: no window can be opened')
            assert '--png FILE' in line


def test_a_window_is_drawn_again_and_again_until_it_is_closed():
    """There is no graph, so no data: that is no error."""
    with live.private_domain() as environment:
        extra = {
            'MPLBACKEND': 'module://fake_window',
            'CLOSE_AFTER': '6',
            'PYTHONPATH': os.pathsep.join([str(live.ROOT / 'test'), environment.get('PYTHONPATH', '')]),
        }
        with watching({**without_display(environment), **extra}, '--every', '0.1') as process:
            output, _ = process.communicate(timeout=live.TIMEOUT)
    assert process.returncode == 0, output
    words = output.split()
    assert words[0] == 'opened'
    assert words.count('drawn') >= 2

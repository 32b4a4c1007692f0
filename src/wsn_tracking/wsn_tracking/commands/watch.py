"""`wsn-tracking watch`."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from wsn_tracking.commands.base import Commands, add_command, seconds

SILENT = 3.0  # [s] without a message, after which the map says so


def add(commands: Commands) -> None:
    """Describe the command."""
    command = add_command(
        commands,
        'watch',
        _do,
        'show a running graph on a live map, in a window or in a PNG file',
        '--outputs fused_1,local_2',
        '--png live.png --every 0.5',
    )
    command.add_argument('--png', metavar='FILE', help='rewrite this file instead of opening a window')
    command.add_argument('--outputs', type=_names, default=(), metavar='A,B', help='estimates (default: one of a kind)')
    command.add_argument('--every', type=_period, default=1.0, metavar='S', help='seconds between maps (default: 1)')
    command.add_argument('--epochs', type=_count, default=120, metavar='N', help='length of the tracks (default: 120)')
    command.add_argument('--namespace', default='', help='namespace of the graph')


def _do(options: argparse.Namespace) -> int:
    from wsn_tracking.nodes.watcher import watching
    from wsn_tracking.viewing.live_window import Png, Window
    from wsn_tracking.viewing.scene import Scene, pick

    choose: Callable[[Iterable[str]], Sequence[str]] = (lambda _: options.outputs) if options.outputs else pick
    title = f'wsn_tracking {options.namespace}'.rstrip()
    try:
        view = Png(Path(options.png), title) if options.png else Window(title)
        with watching(Scene(options.epochs), choose, options.namespace) as watcher:
            running = True
            while running and view.is_open:
                silence = watcher.silence
                view.show(watcher.scene, f'silent for {silence:.0f} s' if silence and silence > SILENT else '')
                running = watcher.spin(options.every, view.breathe)
    except KeyboardInterrupt:  # before the watching has begun
        pass
    return 0


def _names(text: str) -> tuple[str, ...]:
    names = tuple(filter(None, (name.strip() for name in text.split(','))))
    if not names:
        raise argparse.ArgumentTypeError(f'{text!r} names no output: expected e.g. fused_1,local_2')
    return names


def _period(text: str) -> float:
    value = seconds(text)
    if value < 0.05:
        raise argparse.ArgumentTypeError(f'{text!r} is too often: expected seconds, 0.05 or more')
    return value


def _count(text: str) -> int:
    if not text.isdecimal() or not 2 <= int(text) <= 100_000:
        raise argparse.ArgumentTypeError(f'{text!r} is no length: expected an integer from 2 to 100000')
    return int(text)

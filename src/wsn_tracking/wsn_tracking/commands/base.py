"""What the commands share: how one is described, and the options of those that track."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from wsn_tracking.configuration import configuration_names, parse_setting
from wsn_tracking.graphs import SYSTEMS
from wsn_tracking.parameters import Values
from wsn_tracking.sensing.channel_file import check_channel

Commands = Any  # what argparse's add_subparsers returns; it has no public name


def add_command(
    commands: Commands, name: str, do: Callable[[argparse.Namespace], int], words: str, *examples: str
) -> argparse.ArgumentParser:
    """A command with one line of help and the examples that its --help shows; `do` gives the exit code."""
    shown = '\n'.join(f'  wsn-tracking {name} {example}'.rstrip() for example in examples)
    command: argparse.ArgumentParser = commands.add_parser(
        name,
        help=words,
        description=words[0].upper() + words[1:] + '.',
        epilog=f'examples:\n{shown}',
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    command.set_defaults(do=do)
    return command


def add_bag(command: argparse.ArgumentParser, *, several: bool = False) -> None:
    """The bag, or the bags, that a command reads."""
    words = 'rosbag2 folder or .mcap file'
    if several:
        command.add_argument('bags', nargs='+', metavar='BAG', help=words)
    else:
        command.add_argument('bag', metavar='BAG', help=words)
    command.add_argument('--namespace', help='namespace in the bag, where it holds several')


def add_tracking(command: argparse.ArgumentParser, *, scores: bool = True) -> None:
    """Options of the commands that track, and of those among them that score."""
    named = ', '.join(configuration_names())
    systems = ', '.join(SYSTEMS)
    command.add_argument(
        '--trackers', default='', metavar='NAMES', help=f'some of {systems}, or all; default: as the bag asks'
    )
    command.add_argument('--config', default='', help=f'parameter file or name ({named}); default: what the bag names')
    command.add_argument('--channel', metavar='FILE', default='', help='radios as `calibrate` found them')
    command.add_argument('--set', action='append', default=[], metavar='NAME=VALUE', help='set one parameter')
    command.add_argument('--target', type=target, default=-1, metavar='ID', help='default: the first in the bag')
    command.add_argument('--skip', type=seconds, default=5.0, help='seconds that are not scored (default: 5)')
    if not scores:
        return
    command.add_argument('--json', metavar='FILE', help='write the scores for machines')
    command.add_argument('--plot', metavar='DIR', help='draw map, errors and NEES as PNG')


def settings(options: argparse.Namespace) -> Values:
    """What --set and --channel say."""
    given = dict(parse_setting(text) for text in options.set)
    if options.channel:
        path = str(Path(options.channel).resolve())
        check_channel(path)
        given['channel'] = path
    return given


def seconds(text: str) -> float:
    """A time that is not negative."""
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0.0 <= value < 1e9:
        raise argparse.ArgumentTypeError(f'{text!r} is no time: expected seconds, 0 or more')
    return value


def seed(text: str) -> int:
    """A seed of random draws."""
    if not text.isdecimal() or int(text) >= 2**63:
        raise argparse.ArgumentTypeError(f'{text!r} is no seed: expected an integer from 0 to 2^63 - 1')
    return int(text)


def target(text: str) -> int:
    """A target id."""
    if not text.isdecimal() or int(text) > 65535:
        raise argparse.ArgumentTypeError(f'{text!r} is no target: expected an id from 0 to 65535')
    return int(text)


def rate(text: str) -> float:
    """A speed; `max` is 0, which sets none."""
    if text == 'max':
        return 0.0
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0.0 < value <= 1e6:
        raise argparse.ArgumentTypeError(f'{text!r} is no speed: expected a positive multiple of real time, or max')
    return value


def progress(title: str) -> Callable[[Iterator[Any], int], Iterator[Any]]:
    """A progress bar on a terminal, nothing elsewhere."""

    def shown(items: Iterator[Any], total: int) -> Iterator[Any]:
        if not sys.stderr.isatty():
            yield from items
            return
        from rich.console import Console
        from rich.progress import track

        yield from track(items, title, total, console=Console(stderr=True), transient=True)

    return shown

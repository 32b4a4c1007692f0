"""`wsn-tracking sink probe` and `sink dump`: what is at a serial port, or in a file of bytes captured there."""

from __future__ import annotations

import argparse
import itertools
import time
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from wsn_tracking.commands import sink_simulate, sink_track
from wsn_tracking.commands.base import Commands, add_command, seconds

if TYPE_CHECKING:
    from wsn_tracking.zstack.protocols import Tap
    from wsn_tracking.zstack.settings import LinkConfig


def add(commands: Commands) -> None:
    """Describe the command."""
    command = add_command(
        commands,
        'sink',
        _look,
        'look at a sink, track on what it delivers, or simulate one',
        'probe /dev/ttyACM0',
        'dump /dev/serial/by-id/usb-Texas_Instruments_CC2531-if00 --hex',
        'dump captured.bin',
        'track --config my_field.yaml --record walk',
        'simulate --link my_sink',
    )
    kinds = command.add_subparsers(dest='what', required=True, metavar='WHAT')
    _add_look(kinds, 'probe', 'what is there: firmware, network, scale of LQI')
    _add_look(kinds, 'dump', 'every frame, decoded').add_argument(
        '--hex', action='store_true', help='the bytes as well'
    )
    sink_track.add(kinds)
    sink_simulate.add(kinds)


def _add_look(kinds: Commands, name: str, words: str) -> argparse.ArgumentParser:
    """One way to look at a sink."""
    look: argparse.ArgumentParser = kinds.add_parser(name, help=words, description=words[0].upper() + words[1:] + '.')
    look.set_defaults(do=_look)
    look.add_argument('port', metavar='PORT', help='serial port, or a file of captured bytes')
    look.add_argument('--protocol', choices=['znp', 'mt_app', 'ascii'], default='znp', help='what the sink speaks')
    look.add_argument('--baud', type=int, default=115200, help='speed of a UART (default: 115200)')
    look.add_argument('--rtscts', action='store_true', help='hardware flow control')
    look.add_argument(
        '--seconds', type=seconds, metavar='S', help='how long to listen (default: probe 2, dump until Ctrl-C)'
    )
    look.add_argument('--set', action='append', default=[], metavar='NAME=VALUE', help='set any parameter of the link')
    return look


def _look(options: argparse.Namespace) -> int:
    from wsn_tracking.errors import TrackingError
    from wsn_tracking.parameters import build, specs
    from wsn_tracking.ros_yaml import parse
    from wsn_tracking.zstack.settings import LinkConfig

    given: dict[str, Any] = {
        'port': options.port,
        'sink_protocol': options.protocol,
        'baud': options.baud,
        'rtscts': options.rtscts,
    }
    names = [spec.name for spec in specs(LinkConfig)]
    for text in options.set:
        name, equals, value = text.partition('=')
        if not equals or name not in names:
            raise TrackingError(f'--set {text}: expected NAME=VALUE, NAME one of {", ".join(names)}')
        given[name] = parse(value, f'--set {text}')
    config = build(LinkConfig, given)
    return (_probe if options.what == 'probe' else _dump)(config, options)


def _probe(config: LinkConfig, options: argparse.Namespace) -> int:
    from wsn_tracking.zstack.survey import Survey

    survey = Survey()
    counters = _run(config, survey.add, 2.0 if options.seconds is None else options.seconds, questions=True)
    for line in survey.lines(config.lqi_scale):
        print(line)
    print(f'line      {_counted(counters)}')
    return 0


def _dump(config: LinkConfig, options: argparse.Namespace) -> int:
    from wsn_tracking.zstack.capture import is_capture
    from wsn_tracking.zstack.describe import describe
    from wsn_tracking.zstack.frames import Frame, encode_frame
    from wsn_tracking.zstack.lqi import SCALES
    from wsn_tracking.zstack.protocols import Item

    began, is_file, shown = time.monotonic(), is_capture(config.port), itertools.count(1)

    def show(raw: Frame | bytes, item: Item) -> None:
        when = f'#{next(shown):<8}' if is_file else f'{time.monotonic() - began:9.3f}'
        print(f'{when} {describe(raw, item, SCALES[config.lqi_scale])}', flush=not is_file)
        if options.hex:
            print(' ' * 10 + (raw if isinstance(raw, bytes) else encode_frame(raw)).hex(' ').upper())

    counters = _run(config, show, options.seconds, questions=False)
    print(_counted(counters))
    return 0


def _counted(counters: Mapping[str, int]) -> str:
    return ', '.join(
        f'{name.replace("_", " ")} {n}' for name, n in counters.items() if n or name in {'frames', 'lines'}
    )


def _run(config: LinkConfig, tap: Tap, duration: float | None, *, questions: bool) -> Mapping[str, int]:
    """Have everything shown to `tap` that a port or a file says; what was counted."""
    from wsn_tracking.errors import TrackingError
    from wsn_tracking.zstack.capture import is_capture, read_capture
    from wsn_tracking.zstack.listening import listen
    from wsn_tracking.zstack.protocols import protocol_of

    protocol = protocol_of(config.sink_protocol, config.radio, config.timeout.gap, tap)
    if is_capture(config.port):
        data = read_capture(config.port)
        protocol.feed(data, 0.0)
        protocol.flush()
        if not any(protocol.counters.get(name) for name in ('frames', 'lines')):
            raise TrackingError(
                f'nothing in {config.port} ({len(data)} bytes) was said by a sink of {config.sink_protocol}: expected '
                'what was captured from its line, raw or in hexadecimal; --protocol names another kind of sink'
            )
    else:
        listen(config, protocol, duration, questions=questions)
    return protocol.counters

"""`wsn-tracking sink simulate`: a serial port that behaves as a sink does, without ROS."""

from __future__ import annotations

import argparse
import signal
import time
from typing import TYPE_CHECKING, Any

from wsn_tracking.commands.base import Commands, rate, seconds, seed, target

if TYPE_CHECKING:
    from wsn_tracking.zstack.pty_loop import PtyLoop

EXAMPLES = """examples:
  wsn-tracking sink simulate --link my_sink
  wsn-tracking sink simulate --link my_sink --flavour zstack_3_0 --new
  wsn-tracking sink simulate --link my_sink --bag bags/a_loop --fault reset=20 --fault bad_fcs=0.05
  wsn-tracking sink simulate --link my_sink --scenario a_circle --rate 10 --set traffic.max_hops=4

faults, each with what its value is and the default:
"""


def add(commands: Commands) -> None:
    """Describe the command below `sink`."""
    from wsn_tracking.simulation.scenarios import SCENARIOS
    from wsn_tracking.zstack.faults import FAULTS
    from wsn_tracking.zstack.firmware.flavour import FLAVOURS

    listed = '\n'.join(f'  {name:17} {kind.value} {kind.default:<5g} {kind.words}' for name, kind in FAULTS.items())
    command: argparse.ArgumentParser = commands.add_parser(
        'simulate',
        help='a port that behaves as a CC2530 sink, with a world or a bag behind it',
        description='A serial port that behaves as a CC2530 sink with Z-Stack does, with a world or a bag behind it.',
        epilog=EXAMPLES + listed,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    command.set_defaults(do=_do)
    command.add_argument('--link', required=True, metavar='PATH', help='symbolic link that is made to the port')
    source = command.add_mutually_exclusive_group()
    source.add_argument('--scenario', choices=sorted(SCENARIOS), default='a_loop', help='experiment behind the sink')
    source.add_argument('--bag', metavar='BAG', default='', help='rosbag2 folder or .mcap file behind the sink')
    command.add_argument('--target', type=target, default=-1, metavar='ID', help='the one target that is there')
    command.add_argument('--seed', type=seed, default=0, help='of noise, nodes and faults (default: 0)')
    command.add_argument('--rate', type=rate, default=1.0, help='multiple of real time, or max (default: 1)')
    command.add_argument('--flavour', choices=sorted(FLAVOURS), default='home_1_2', help='firmware')
    command.add_argument('--new', action='store_true', help='the sink remembers no network')
    command.add_argument('--protocol', choices=['znp', 'mt_app', 'ascii'], default='znp', help='what the sink speaks')
    command.add_argument('--fault', action='append', default=[], metavar='NAME[=VALUE]', help='what goes wrong')
    command.add_argument('--set', action='append', default=[], metavar='NAME=VALUE', help='set any other parameter')
    command.add_argument('--linger', type=seconds, default=0.0, metavar='S', help='end so long after the last message')


def _do(options: argparse.Namespace) -> int:
    from wsn_tracking.airwaves import air_epochs, on_board, recording_of
    from wsn_tracking.parameters import build
    from wsn_tracking.zstack.pty_loop import PtyLoop
    from wsn_tracking.zstack.pty_port import PtyPort
    from wsn_tracking.zstack.simulator import Simulator
    from wsn_tracking.zstack.simulator_settings import SimulatorConfig

    config = build(SimulatorConfig, _values(options))
    epochs = air_epochs(recording_of(options.scenario, options.bag, options.seed, options.target))
    simulator = Simulator(config, epochs, time.monotonic(), on_board(config.traffic.alpha))
    port = PtyPort(config.link)
    loop = PtyLoop(simulator, port)
    port.plug()
    print(f'{config.link} -> {port.device}: {config.flavour}, {len(epochs)} epochs; Ctrl-C ends it', flush=True)
    before = [signal.signal(number, signal.default_int_handler) for number in (signal.SIGTERM, signal.SIGHUP)]
    try:
        _turn(loop, options.linger)
    except KeyboardInterrupt:
        pass
    finally:
        port.unplug()
        for number, handler in zip((signal.SIGTERM, signal.SIGHUP), before, strict=True):
            signal.signal(number, handler)
    counted = {**simulator.counters, **{type(fault).__name__: fault.strikes for fault in simulator.faults}}
    print(', '.join(f'{name} {n}' for name, n in counted.items()) or 'nobody was there')
    return 0


def _values(options: argparse.Namespace) -> dict[str, Any]:
    from wsn_tracking.errors import TrackingError
    from wsn_tracking.parameters import specs
    from wsn_tracking.ros_yaml import parse
    from wsn_tracking.zstack.simulator_settings import SimulatorConfig

    values: dict[str, Any] = {
        'link': options.link,
        'flavour': options.flavour,
        'formed': not options.new,
        'sink_protocol': options.protocol,
        'seed': options.seed,
        'rate': options.rate,
        'faults': options.fault or [''],
    }
    names = [spec.name for spec in specs(SimulatorConfig)]
    for text in options.set:
        name, equals, value = text.partition('=')
        if not equals or name not in names:
            raise TrackingError(f'--set {text}: expected NAME=VALUE, NAME one of {", ".join(names)}')
        values[name] = parse(value, f'--set {text}')
    return values


def _turn(loop: PtyLoop, linger: float) -> None:
    """Until interrupted, or so long after the end; what the host tells the nodes is shown."""
    begun = ended = False
    end = float('inf')
    while time.monotonic() < end:
        loop.turn()
        if loop.begun is not None and not begun:
            begun = True
            print('a host listens: the nodes speak', flush=True)
        while loop.simulator.told:
            _, dst, record = loop.simulator.told.popleft()
            print(f'to {dst:#06x}: {record}', flush=True)
        if loop.finished and not ended:
            ended = True
            end = time.monotonic() + linger if linger else end
            print('all was sent', flush=True)

"""`wsn-tracking sink track`: the live graph behind a sink; what `serial_bridge.launch.py` does, from a plain shell."""

from __future__ import annotations

import argparse

from wsn_tracking.commands.base import Commands, settings
from wsn_tracking.configuration import configuration_names
from wsn_tracking.graphs import SYSTEMS

EXAMPLES = """examples:
  wsn-tracking sink track --config my_field.yaml
  wsn-tracking sink track --config my_field.yaml --record walk
  wsn-tracking sink track my_sink --trackers random_q,loss_tolerant --set period=0.5
"""


def add(commands: Commands) -> None:
    """Describe the command below `sink`."""
    command: argparse.ArgumentParser = commands.add_parser(
        'track',
        help='track live on what a sink delivers, and record it',
        description='Track live on what a sink delivers, until Ctrl-C.',
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    command.set_defaults(do=_do)
    command.add_argument('port', metavar='PORT', nargs='?', help='serial port (default: that of the configuration)')
    command.add_argument(
        '--config',
        default='serial_bridge',
        help=f'parameter file or name ({", ".join(configuration_names())}; default: serial_bridge)',
    )
    command.add_argument(
        '--trackers', default='', metavar='NAMES', help=f'some of {", ".join(SYSTEMS)}, or all; default: random_q'
    )
    command.add_argument('--level', choices=['rssi', 'range'], default='rssi', help='what the nodes report')
    command.add_argument('--channel', metavar='FILE', default='', help='radios as `calibrate` found them')
    command.add_argument('--set', action='append', default=[], metavar='NAME=VALUE', help='set one parameter')
    command.add_argument('--record', metavar='BAG', default='', help='record what the sink delivers into a new bag')
    command.add_argument('--markers', action='store_true', help='publish markers for RViz and Foxglove')


def _do(options: argparse.Namespace) -> int:
    from wsn_tracking import graphs
    from wsn_tracking.files import check_new_folder
    from wsn_tracking.processes import run_graph

    if options.record:
        check_new_folder(options.record)
    graph = graphs.serial(
        options.config,
        trackers=options.trackers,
        level=options.level,
        settings={**({'port': options.port} if options.port else {}), **settings(options)},
        record=options.record,
        markers=options.markers,
    )
    try:
        return run_graph(graph, ['serial_bridge'])
    except KeyboardInterrupt:  # how it is meant to end
        return 0

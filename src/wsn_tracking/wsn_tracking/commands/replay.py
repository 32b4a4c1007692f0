"""`wsn-tracking replay`."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

from wsn_tracking import graphs
from wsn_tracking.commands.base import Commands, add_bag, add_command, add_tracking, rate, settings
from wsn_tracking.files import check_new_folder


def add(commands: Commands) -> None:
    """Describe the command."""
    command = add_command(
        commands,
        'replay',
        _do,
        'play a bag through the live graph and score it there; equal to `evaluate` to the last bit',
        'bags/a_loop --rate max',
        'bags/a_loop --rate 20 --one-process-each',
        'bags/d_phase --rate max --trackers all',
    )
    add_bag(command)
    add_tracking(command)
    command.add_argument('--rate', type=rate, default=1.0, help='multiple of real time, or max (default: 1)')
    command.add_argument('--record', metavar='BAG', help='record what a replay needs into a new bag')
    command.add_argument('--derived', action='store_true', help='with --record: estimates and their odometry as well')
    command.add_argument('--one-process-each', action='store_true', help='a process for every node that senses')
    command.add_argument('--markers', action='store_true', help='publish markers for RViz and Foxglove')


def _record(options: argparse.Namespace) -> dict[str, Any] | None:
    """Parameters of the recorder, where there is one."""
    if not options.record:
        return None
    return {'output': str(Path(options.record).resolve()), **({'derived': True} if options.derived else {})}


def _do(options: argparse.Namespace) -> int:
    from wsn_tracking.processes import run_graph

    if options.record:
        check_new_folder(options.record)
    evaluator: dict[str, Any] = {'skip': options.skip}
    for name in ('json', 'plot'):
        if getattr(options, name):
            evaluator[name] = str(Path(getattr(options, name)).resolve())
    processes = graphs.replay(
        options.bag,
        rate=options.rate,
        trackers=options.trackers,
        configuration=options.config,
        settings=settings(options),
        target_id=options.target,
        namespace=options.namespace,
        evaluator=evaluator,
        record=_record(options),
        one_process_each=options.one_process_each,
        markers=options.markers,
        progress=sys.stderr.isatty(),
    )
    return run_graph(processes, [p.name for p in processes if p.name in {'evaluator', 'bag_recorder'}])

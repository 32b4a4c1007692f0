"""`wsn-tracking simulate`."""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

from wsn_tracking import graphs
from wsn_tracking.commands.base import Commands, add_command, seed
from wsn_tracking.files import check_new_folder
from wsn_tracking.simulation.record import START_NS, record
from wsn_tracking.simulation.scenarios import SCENARIOS, scenario, settings_of


def add(commands: Commands) -> None:
    """Describe the command."""
    command = add_command(
        commands,
        'simulate',
        _do,
        'write the bag of a simulated experiment',
        'a_loop -o my_loop',
        'a_loop --seed 7 -o seven',
        'a_loop --seed 1 --live -o bags/a_loop',
        'b_field --set faults=clutter --set dead=[7] -o one_dies',
    )
    command.add_argument('scenario', choices=sorted(SCENARIOS), help='experiment')
    command.add_argument('--seed', type=seed, default=0, help='of noise and drawn walks (default: 0)')
    command.add_argument('--live', action='store_true', help='record it through the live graph, not directly')
    command.add_argument(
        '--set', action='append', default=[], metavar='NAME=VALUE', help='set one parameter of the scenario'
    )
    command.add_argument('-o', '--output', required=True, metavar='BAG', help='folder to write; it must not exist')


def _do(options: argparse.Namespace) -> int:
    check_new_folder(options.output)
    if options.live:
        return _live(options)
    from wsn_tracking.bags.save import save

    simulated = scenario(options.scenario, settings_of(options.set), options.seed)
    recording = record(simulated, options.seed)
    save(options.output, recording)
    print(f'{options.output}: {options.scenario}, seed {options.seed}, {len(recording.messages)} messages')
    return 0


def _live(options: argparse.Namespace) -> int:
    """Record what the world sends through the real graph, then write it anew with zero padding and its own stamps."""
    from wsn_tracking.bags.rewrite import canonical
    from wsn_tracking.processes import run_graph

    with tempfile.TemporaryDirectory(prefix='wsn_tracking_') as folder:
        raw = Path(folder, Path(options.output).name)
        processes = graphs.simulation(
            options.scenario,
            options.seed,
            scenario_settings=options.set,
            rate=0.0,
            start_stamp=START_NS * 1e-9,
            record=str(raw),
        )
        code = run_graph(processes, ['evaluator', 'bag_recorder'])
        if code == 0:
            canonical(raw, options.output)
    return code

"""The command line: `wsn-tracking <command>`."""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from wsn_tracking import graphs
from wsn_tracking.bags.read import read
from wsn_tracking.configuration import (
    Values,
    configuration_names,
    parse_setting,
)
from wsn_tracking.errors import TrackingError
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.simulation.scenarios import SCENARIOS


def main(arguments: Sequence[str] | None = None) -> None:
    """Run one command; an error is one line and exit code 1, a wrong call exit code 2."""
    options = _parser().parse_args(arguments)
    try:
        code = options.do(options)
    except TrackingError as error:
        print(f'wsn-tracking {options.command}: error: {error}', file=sys.stderr)
        code = 1
    except BrokenPipeError:  # the reader of our output has gone, as `| head` does
        sys.stderr.close()
        code = 141
    except KeyboardInterrupt:
        code = 130
    sys.exit(code)


# ---- the commands


def _info(options: argparse.Namespace) -> int:
    from wsn_tracking.bags.info import describe

    print(describe(read(options.bag, options.namespace)))
    return 0


def _simulate(options: argparse.Namespace) -> int:
    from wsn_tracking.bags.save import save
    from wsn_tracking.simulation.record import record
    from wsn_tracking.simulation.scenarios import scenario

    if options.live:
        return _simulate_live(options)
    recording = record(scenario(options.scenario), options.seed)
    save(options.output, recording)
    print(f'{options.output}: {options.scenario}, seed {options.seed}, {len(recording.messages)} messages')
    return 0


def _simulate_live(options: argparse.Namespace) -> int:
    """Record what the world sends through the real graph, then write it anew with zero padding and its own stamps."""
    from wsn_tracking.bags.rewrite import canonical
    from wsn_tracking.processes import run_graph
    from wsn_tracking.simulation.record import START_NS

    with tempfile.TemporaryDirectory(prefix='wsn_tracking_') as folder:
        raw = Path(folder, Path(options.output).name)
        processes = graphs.simulation(
            options.scenario, options.seed, rate=0.0, start_stamp=START_NS * 1e-9, record=str(raw)
        )
        code = run_graph(processes, ['evaluator', 'bag_recorder'])
        if code == 0:
            canonical(raw, options.output)
    return code


def _import(options: argparse.Namespace) -> int:
    from wsn_tracking.bags.danis import import_danis

    for path in import_danis(options.source, options.output):
        print(path)
    return 0


def _evaluate(options: argparse.Namespace) -> int:
    from wsn_tracking.evaluation.plots import plot_all
    from wsn_tracking.evaluation.report_json import write_json
    from wsn_tracking.evaluation.run import summarise
    from wsn_tracking.evaluation.table import format_tables, wants_colour
    from wsn_tracking.offline import offline

    summaries = []
    for bag in options.bags:
        source, recording = graphs.open_bag(bag, options.namespace)
        run = offline(
            source,
            recording,
            options.config or '',
            _settings(options),
            options.target,
            _progress(source.title),
        )
        summaries.append(summarise(source.title, recording, run, options.skip))
        if options.plot:
            folder = Path(options.plot, source.title) if len(options.bags) > 1 else Path(options.plot)
            truth = recording.truth.get(summaries[-1].target_id or 0)
            plot_all(
                folder,
                recording.anchors,
                truth,
                run.estimates,
                _area(recording),
                title=source.title,
                start_ns=run.start_ns,
                skip_s=options.skip,
            )
        if not recording.truth:
            print(f'{bag}: no truth/target_<id> in the bag, so nothing can be scored', file=sys.stderr)
    print(format_tables(summaries, colour=wants_colour(sys.stdout)))
    if options.json:
        write_json(options.json, summaries)
    return 0 if all(summary.outputs for summary in summaries) else 1


def _replay(options: argparse.Namespace) -> int:
    from wsn_tracking.processes import run_graph

    evaluator: dict[str, Any] = {'skip': options.skip}
    if options.json:
        evaluator['json'] = str(Path(options.json).resolve())
    if options.plot:
        evaluator['plot'] = str(Path(options.plot).resolve())
    processes = graphs.replay(
        options.bag,
        rate=options.rate,
        configuration=options.config or '',
        settings=_settings(options),
        target_id=options.target,
        namespace=options.namespace,
        evaluator=evaluator,
        record={'output': str(Path(options.record).resolve())} if options.record else None,
        one_process_each=options.one_process_each,
        progress=sys.stderr.isatty(),
    )
    return run_graph(processes, [p.name for p in processes if p.name in ('evaluator', 'bag_recorder')])


# ---- what they share


def _settings(options: argparse.Namespace) -> Values:
    return dict(parse_setting(text) for text in options.set)


def _area(recording: Recording) -> Any:
    edges = [float(edge) for edge in recording.metadata.get('area', '').split()]
    return tuple(edges) if len(edges) == 4 else None


def _progress(title: str) -> Callable[[Iterator[Any], int], Iterator[Any]]:
    """A progress bar on a terminal, nothing elsewhere."""

    def shown(items: Iterator[Any], total: int) -> Iterator[Any]:
        if not sys.stderr.isatty():
            yield from items
            return
        from rich.console import Console
        from rich.progress import track

        yield from track(items, title, total, console=Console(stderr=True), transient=True)

    return shown


def _rate(text: str) -> float:
    """A speed; `max` is 0, which sets none."""
    if text == 'max':
        return 0.0
    try:
        rate = float(text)
    except ValueError:
        rate = -1.0
    if not 0.0 < rate <= 1e6:
        raise argparse.ArgumentTypeError(f'{text!r} is no speed: expected a positive multiple of real time, or max')
    return rate


# ---- the words


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog='wsn-tracking',
        description='Track moving targets from the signal strengths and ranges of a wireless sensor network.',
    )
    commands = parser.add_subparsers(dest='command', required=True, metavar='COMMAND')

    def add(name: str, do: Callable[[argparse.Namespace], int], words: str, *examples: str) -> argparse.ArgumentParser:
        shown = '\n'.join(f'  wsn-tracking {name} {example}' for example in examples)
        command = commands.add_parser(
            name,
            help=words,
            description=words[0].upper() + words[1:] + '.',
            epilog=f'examples:\n{shown}',
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        command.set_defaults(do=do)
        return command

    info = add('info', _info, 'say what a bag holds', 'bags/a_loop')
    info.add_argument('bag', help='rosbag2 folder or .mcap file')
    info.add_argument('--namespace', help='namespace in the bag, where it holds several')

    simulate = add(
        'simulate',
        _simulate,
        'write the bag of a simulated experiment',
        'a_loop -o my_loop',
        'a_loop --seed 7 -o seven',
    )
    simulate.add_argument('scenario', choices=sorted(SCENARIOS), help='experiment')
    simulate.add_argument('--seed', type=_seed, default=0, help='of the radio noise (default: 0)')
    simulate.add_argument('--live', action='store_true', help='record it through the live graph, not directly')
    simulate.add_argument('-o', '--output', required=True, help='folder to write; it must not exist')

    imports = add(
        'import',
        _import,
        'turn a public recording into bags',
        'danis Position-Annotated-BLE-RSSI-Dataset -o danis',
    )
    imports.add_argument('kind', choices=['danis'], help='which recording (docs/datasets.md)')
    imports.add_argument('source', help='folder of the recording')
    imports.add_argument('-o', '--output', required=True, help='folder for the bags')

    evaluate = add(
        'evaluate',
        _evaluate,
        'run the trackers on bags without any middleware and score them',
        'bags/a_loop',
        'bags/a_loop --json scores.json --plot plots',
        'bags/a_loop --set trigger.kind=near --set trigger.y_min=-46.9 --set update.kind=iplf',
        'danis/* --config danis_three',
    )
    evaluate.add_argument('bags', nargs='+', metavar='BAG', help='rosbag2 folders or .mcap files')
    _add_tracking(evaluate)

    replay = add(
        'replay',
        _replay,
        'play a bag through the live graph and score it there; equal to `evaluate` to the last bit',
        'bags/a_loop --rate max',
        'bags/a_loop --rate 20 --one-process-each',
    )
    replay.add_argument('bag', help='rosbag2 folder or .mcap file')
    _add_tracking(replay)
    replay.add_argument('--rate', type=_rate, default=1.0, help='multiple of real time, or max (default: 1)')
    replay.add_argument('--record', metavar='FOLDER', help='record what a replay needs into a new bag')
    replay.add_argument('--one-process-each', action='store_true', help='a process for every sensing node')
    return parser


def _seed(text: str) -> int:
    if not text.isdigit():
        raise argparse.ArgumentTypeError(f'{text!r} is no seed: expected a non-negative integer')
    return int(text)


def _add_tracking(command: argparse.ArgumentParser) -> None:
    named = ', '.join(configuration_names())
    command.add_argument('--trackers', choices=['random_q', 'all'], default='random_q', help='systems that track')
    command.add_argument('--config', help=f'parameter file or name ({named}); default: what the bag names')
    command.add_argument('--set', action='append', default=[], metavar='NAME=VALUE', help='set one parameter')
    command.add_argument('--target', type=int, default=-1, help='target id (default: the first in the bag)')
    command.add_argument('--skip', type=float, default=5.0, help='seconds that are not scored (default: 5)')
    command.add_argument('--json', metavar='FILE', help='write the scores for machines')
    command.add_argument('--plot', metavar='DIR', help='draw map, errors and NEES as PNG')
    command.add_argument('--namespace', help='namespace in the bag, where it holds several')


if __name__ == '__main__':
    main()

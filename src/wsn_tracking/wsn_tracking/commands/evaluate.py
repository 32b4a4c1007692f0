"""`wsn-tracking evaluate`."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from wsn_tracking import graphs
from wsn_tracking.commands.base import Commands, add_bag, add_command, add_tracking, progress, settings
from wsn_tracking.commands.plot import draw
from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation.summary import Summary
from wsn_tracking.sensing.recording import Recording

FLAT = 0.05  # [m] heights below do not show in ranges of some metres


def add(commands: Commands) -> None:
    """Describe the command."""
    command = add_command(
        commands,
        'evaluate',
        _do,
        'run the trackers on bags without any middleware and score them',
        'bags/a_loop',
        'bags/a_loop --json scores.json --plot plots',
        'bags/a_loop --set trigger.kind=near --set trigger.y_min=-46.9 --set update.kind=iplf',
        'danis/* --config danis_three',
    )
    add_bag(command, several=True)
    add_tracking(command)


def _do(options: argparse.Namespace) -> int:
    from wsn_tracking.evaluation.report_json import write_json
    from wsn_tracking.evaluation.table import format_tables, wants_colour

    titles = [Path(bag).resolve().name for bag in options.bags]
    doubled = sorted({title for title in titles if titles.count(title) > 1})
    if options.plot and doubled:
        raise TrackingError(f'several bags are called {", ".join(doubled)}: their plots need folders of their own')
    summaries = [_evaluated(bag, options) for bag in options.bags]
    print(format_tables(summaries, colour=wants_colour(sys.stdout)))
    if options.json:
        write_json(options.json, summaries)
    return 0 if all(summary.outputs for summary in summaries) else 1


def _evaluated(bag: str, options: argparse.Namespace) -> Summary:
    from wsn_tracking.evaluation.run import summarise
    from wsn_tracking.offline import offline

    source, recording = graphs.open_bag(bag, options.namespace)
    run = offline(
        source,
        recording,
        options.config,
        settings(options),
        options.target,
        progress(source.title),
        options.trackers,
    )
    summary = summarise(source.title, recording, run, options.skip)
    if not summary.outputs:
        print(f'{bag}: no truth/target_<id> of what was tracked, so nothing can be scored', file=sys.stderr)
    if not options.config and 'target_height' not in {**source.metadata, **settings(options)}:
        _ask_for_height(bag, recording)
    if options.plot:
        folder = Path(options.plot, source.title) if len(options.bags) > 1 else Path(options.plot)
        draw(folder, source, recording, run, options.skip)
    return summary


def _ask_for_height(bag: str, recording: Recording) -> None:
    """Distances are three-dimensional: where nobody tells how high the target is, its truth may contradict 0 m."""
    heights = [height for truth in recording.truth.values() for height in truth.positions[:, 2].tolist()]
    height = sorted(heights)[len(heights) // 2] if heights else 0.0
    if abs(height) > FLAT:
        told = f'the truth is {height:.2f} m high, the trackers were told 0 m: try --set target_height={height:.2f}'
        print(f'{bag}: {told}', file=sys.stderr)

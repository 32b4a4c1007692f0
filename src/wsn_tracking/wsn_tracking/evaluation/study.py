"""The long runs, by name; their figures are kept under docs/results.

    python -m wsn_tracking.evaluation.study -o docs/results [NAME ...]

A study is a function without arguments that returns what is worth keeping: numbers, seeds, no times and no paths.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation import (
    study_human,
    study_human_parts,
    study_hybrid,
    study_loss,
    study_phase,
    study_process_noise,
    study_random_q,
    study_triggers,
    study_whole_db,
)
from wsn_tracking.files import write_whole

COMMAND = 'python -m wsn_tracking.evaluation.study -o docs/results'

Study = Callable[[], dict[str, Any]]
STUDIES: Mapping[str, Mapping[str, Study]] = {  # file: its studies
    'system_a': {
        'trigger_rate': study_random_q.trigger_rate,
        'update_forms': study_random_q.update_forms,
        'matched_model': study_random_q.matched_model,
        'process_noise': study_process_noise.process_noise,
        'fusion_rules': study_process_noise.fusion_rules,
        'data_rate': study_triggers.data_rate,
    },
    'whole_db': {'whole_db': study_whole_db.whole_db},
    'human': {
        'profiles': study_human.profiles,
        'circle': study_human.circle,
        'corridor': study_human.corridor,
        'spacing': study_human.spacing,
        'noise': study_human.noise,
        'parts': study_human_parts.parts,
        'teleport': study_human_parts.teleport,
        'needless': study_human_parts.needless,
        'silence': study_human_parts.silence,
        'disc_lag': study_human_parts.disc_lag,
    },
    'loss_tolerant': {
        'loss_rate': study_loss.loss_rate,
        'loss_kind': study_loss.loss_kind,
    },
    'hybrid': {
        'sudden_stop': study_hybrid.sudden_stop,
        'lost_ranges': study_hybrid.lost_ranges,
        'gate': study_hybrid.gate,
        'frozen_gain': study_hybrid.frozen_gain,
    },
    'follower': {'phase': study_phase.phase},
}


def run(
    folder: Path,
    wanted: Sequence[str] = (),
    studies: Mapping[str, Mapping[str, Study]] = STUDIES,
    *,
    command: str = COMMAND,
) -> list[Path]:
    """Run the wanted studies (none: all) and write one file a table; figures of studies that are not run stay."""
    known = [name for table in studies.values() for name in table]
    for name in wanted:
        if name not in known:
            raise TrackingError(f'there is no study `{name}`: expected some of {", ".join(known)}')
    written = []
    for file, table in studies.items():
        chosen = [name for name in table if not wanted or name in wanted]
        if not chosen:
            continue
        path = folder / f'{file}.json'
        _kept(path)  # a file that is none is refused before the work
        made = {}
        for name in chosen:
            print(f'{file}: {name}', file=sys.stderr, flush=True)
            made[name] = {'what': _first_line(table[name]), **table[name]()}
        kept = {name: value for name, value in _kept(path).items() if name in table}  # another run may have added some
        results = {**kept, **made}
        text = json.dumps({'command': command, 'studies': results}, indent=2, sort_keys=True, allow_nan=False)
        write_whole(path, text.encode() + b'\n')
        written.append(path)
    return written


def _kept(path: Path) -> dict[str, Any]:
    """The figures of an earlier run."""
    if not path.exists():
        return {}
    try:
        return dict(json.loads(path.read_bytes())['studies'])
    except (ValueError, KeyError, TypeError) as error:
        raise TrackingError(f'{path} holds no figures of a study: delete it, or name another folder') from error


def _first_line(study: Study) -> str:
    return (study.__doc__ or '').strip().split('\n', 1)[0]


def main(arguments: Sequence[str] | None = None) -> int:
    """Entry point; the exit status."""
    parser = argparse.ArgumentParser(prog='wsn_tracking.evaluation.study', description='Run the long studies.')
    parser.add_argument('names', nargs='*', metavar='NAME', help='studies to run (default: all)')
    parser.add_argument('-o', '--output', type=Path, required=True, metavar='DIR', help='folder of the results')
    options = parser.parse_args(arguments)
    try:
        for path in run(options.output, options.names):
            print(path)
    except TrackingError as error:
        print(f'study: {error}', file=sys.stderr)
        return 1
    return 0


if __name__ == '__main__':
    sys.exit(main())

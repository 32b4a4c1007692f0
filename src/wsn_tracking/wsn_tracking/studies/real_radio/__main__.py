"""The figures of docs/system_a.md, docs/human.md and docs/loss_tolerant.md on real radio.

    python -m wsn_tracking.studies.real_radio DATA -o docs/results [NAME ...]

DATA holds the recordings of docs/datasets.md, each in a folder of its own. Bags and calibrations are made in a
temporary folder: from surveys, or from the first part of a recording, which is not scored.
"""

from __future__ import annotations

import functools
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from wsn_tracking.studies.real_radio.command import call
from wsn_tracking.studies.real_radio.found_again import TABLES as FOUND_AGAIN
from wsn_tracking.studies.real_radio.left_out import TABLES as LEFT_OUT
from wsn_tracking.studies.real_radio.lost import TABLES as SYSTEM_E
from wsn_tracking.studies.real_radio.people import TABLES as SYSTEM_C
from wsn_tracking.studies.real_radio.sets import Sets
from wsn_tracking.studies.real_radio.tables import TABLES as SYSTEM_A
from wsn_tracking.studies.results import make

TABLES = {**SYSTEM_A, **FOUND_AGAIN, **LEFT_OUT, **SYSTEM_C, **SYSTEM_E}
COMMAND = 'python -m wsn_tracking.studies.real_radio DATA -o docs/results'


def run(data: Path, folder: Path, wanted: Sequence[str] = ()) -> Path:
    """Make the wanted tables (none: all) and write real_radio.json; the figures of the others stay."""
    with tempfile.TemporaryDirectory(prefix='wsn_tracking_') as work:
        sets = Sets(data, Path(work))
        studies = {name: functools.wraps(table)(functools.partial(table, sets)) for name, table in TABLES.items()}
        (path,) = make(folder, wanted, {'real_radio': studies}, command=COMMAND)
    return path


def main(arguments: Sequence[str] | None = None) -> int:
    """Entry point; the exit status."""
    return call('real_radio', 'The trackers on public recordings.', TABLES, run, arguments)


if __name__ == '__main__':
    sys.exit(main())

"""From the names of claims to the files of a reproduction."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from wsn_tracking.files import write_whole
from wsn_tracking.reproduction.catalogue import experiments_of
from wsn_tracking.reproduction.claims import Claim
from wsn_tracking.reproduction.content import Setting, content
from wsn_tracking.reproduction.cross import on_recordings, prepared
from wsn_tracking.reproduction.cross_fields import FIELDS
from wsn_tracking.reproduction.cross_table import table
from wsn_tracking.reproduction.digest import digest
from wsn_tracking.reproduction.engine import Progress, Workers, run
from wsn_tracking.reproduction.page import page

COMPARISON = 'X'  # document of the claims on all systems
HTML, JSON, SHORT = 'reproduction.html', 'reproduction.json', 'reproduction.md'


def computed(
    claims: Sequence[Claim],
    setting: Setting,
    workers: Workers,
    progress: Progress = lambda items, total: items,
    data: Path | None = None,
) -> dict[str, Any]:
    """The JSON of these claims, and of the comparison of all systems if it is among them.

    data: folder of real recordings, for that comparison.
    """
    experiments = experiments_of(claims)
    compares = any(claim.document == COMPARISON for claim in claims)
    with tempfile.TemporaryDirectory(prefix='wsn_tracking_') as work:
        absent = {f.name: 'no folder of recordings was given (`--data`).' for f in FIELDS if f.real}
        if compares and data is not None:
            ready, absent = prepared(data, Path(work))
            experiments += on_recordings(ready)
        samples = run(experiments, setting.seed, quick=setting.quick, workers=workers, progress=progress)
    given = f'{" --quick" if setting.quick else ""}{" --data DATA" if data else ""}'
    command = f'./wsn-tracking reproduce {COMPARISON} --seed {setting.seed}{given}'
    tables = [table(samples, command, absent)] if compares else []
    return content(claims, samples, setting, tables=tables)


def write(folder: Path, found: dict[str, Any]) -> list[Path]:
    """The report, what it is made of, and both in short."""
    text = json.dumps(found, indent=1, allow_nan=False) + '\n'
    files = {HTML: page(found), JSON: text, SHORT: digest(found)}  # all are made before the first is written
    for name, told in files.items():
        write_whole(folder / name, told.encode())
    return [folder / name for name in files]

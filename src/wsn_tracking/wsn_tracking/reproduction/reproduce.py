"""From the names of claims to the two files of a reproduction."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from wsn_tracking.files import write_whole
from wsn_tracking.reproduction.catalogue import experiments_of
from wsn_tracking.reproduction.claims import Claim
from wsn_tracking.reproduction.content import Setting, content
from wsn_tracking.reproduction.engine import Progress, Workers, run
from wsn_tracking.reproduction.page import page

SEED = 7001  # no test uses it
HTML, JSON = 'reproduction.html', 'reproduction.json'


def computed(
    claims: Sequence[Claim], setting: Setting, workers: Workers, progress: Progress = lambda items, total: items
) -> dict[str, Any]:
    """The JSON of these claims."""
    samples = run(experiments_of(claims), setting.seed, quick=setting.quick, workers=workers, progress=progress)
    return content(claims, samples, setting)


def write(folder: Path, found: dict[str, Any]) -> list[Path]:
    """Both files."""
    text = json.dumps(found, indent=1, allow_nan=False) + '\n'
    write_whole(folder / JSON, text.encode())
    write_whole(folder / HTML, page(found).encode())
    return [folder / HTML, folder / JSON]

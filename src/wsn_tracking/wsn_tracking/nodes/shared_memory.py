"""Shared memory that killed processes have left behind.

Fast DDS opens a segment for every port of a participant. Of a process that was killed after it had made the file and
before it gave it a size, an empty file is left, and every later process that wants the port waits for it for ever, in
the making of its node.
"""

from __future__ import annotations

import contextlib
import time
from pathlib import Path

FOLDER = Path('/dev/shm')  # noqa: S108 (where shared memory is)
PORTS = 'fastrtps_port*'
LOCK = '_el'  # such files are locks, and always empty
BEING_MADE_S = 2.0  # a living process gives the file its size within microseconds


def remove_unfinished(folder: Path = FOLDER) -> int:
    """Remove segments of ports that nobody will ever finish; how many there were."""
    removed = 0
    for path in folder.glob(PORTS):
        # whoever else starts may remove it first, and what is another user's stays
        with contextlib.suppress(OSError):
            state = path.stat()
            if not (state.st_size or path.name.endswith(LOCK)) and time.time() - state.st_mtime > BEING_MADE_S:
                path.unlink()
                removed += 1
    return removed

"""A process that does not outlive the one that started it, however that ends (Linux)."""

from __future__ import annotations

import ctypes
import os
import signal
import sys
from collections.abc import Mapping

PARENT = 'WSN_TRACKING_PARENT'  # environment variable: id of the process that whoever reads it is to end with
PR_SET_PDEATHSIG = 1


def tied(environment: Mapping[str, str]) -> dict[str, str]:
    """The environment of a process that is to end with this one."""
    return {**environment, PARENT: str(os.getpid())}


def follow() -> None:
    """Get SIGTERM as soon as the process that asked for it has ended, be it killed; where none did, nothing happens."""
    parent = os.environ.pop(PARENT, '')  # what this process starts is not meant
    if not parent.isdecimal() or sys.platform != 'linux':
        return
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)
    try:
        os.kill(int(parent), 0)
    except ProcessLookupError:  # it has ended already
        os.kill(os.getpid(), signal.SIGTERM)

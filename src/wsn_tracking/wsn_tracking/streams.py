"""Standard output: whoever reads it may go, or never have been there."""

from __future__ import annotations

import os
import sys


def give_up_output() -> None:
    """The reader has gone, as `| head` does: what is still to be written goes nowhere, and nobody is told."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def replace_closed_output() -> None:
    """What the caller has closed (`>&-`) goes nowhere; else the next file that is opened would take its place."""
    for number, name in ((1, 'stdout'), (2, 'stderr')):
        if getattr(sys, name) is None:
            os.dup2(os.open(os.devnull, os.O_WRONLY), number)
            setattr(sys, name, os.fdopen(number, 'w', closefd=False))

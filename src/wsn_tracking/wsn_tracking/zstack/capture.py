"""Files of bytes that were captured from a serial line: raw, or written in hexadecimal."""

from __future__ import annotations

import re
from pathlib import Path

from wsn_tracking.errors import TrackingError

MAX_BYTES = 1 << 28
BETWEEN = re.compile(rb'0[xX]|[\s,:]+')
DIGITS = re.compile(rb'(?:[0-9A-Fa-f]{2})+')


def is_capture(name: str) -> bool:
    """Whether the name is that of a file, and not of a port."""
    return Path(name).is_file()


def read_capture(name: str) -> bytes:
    """The bytes of a capture; TrackingError where the file is too large to be one."""
    path = Path(name)
    size = path.stat().st_size
    if size > MAX_BYTES:
        raise TrackingError(f'{name} holds {size} bytes: expected a capture of at most {MAX_BYTES}')
    data = path.read_bytes()
    digits = BETWEEN.sub(b'', data) if data.isascii() else b''
    return bytes.fromhex(digits.decode()) if DIGITS.fullmatch(digits) else data

"""Files of bytes that were captured from a serial line: raw, or written in hexadecimal."""

from __future__ import annotations

import re
from pathlib import Path

from wsn_tracking.errors import TrackingError

MAX_BYTES = 1 << 28
MARK = b'\xef\xbb\xbf'  # with which some editors begin a text
BETWEEN = re.compile(rb'#[^\n]*|0[xX]|[\s,;:-]+')
DIGITS = re.compile(rb'(?:[0-9A-Fa-f]{2})+')


def is_capture(name: str) -> bool:
    """Whether the name is that of a file, and not of a port."""
    return Path(name).is_file()


def read_capture(name: str) -> bytes:
    """The bytes of a capture; TrackingError where the file cannot be read, or is too large to be one."""
    path = Path(name)
    try:
        size = path.stat().st_size
        if size > MAX_BYTES:
            raise TrackingError(f'{name} holds {size} bytes: expected a capture of at most {MAX_BYTES}')
        data = path.read_bytes()
    except OSError as error:
        raise TrackingError(f'{name} cannot be read ({error.strerror}): expected a file of captured bytes') from None
    text = data.removeprefix(MARK)
    digits = BETWEEN.sub(b'', text) if text.isascii() else b''
    whole = digits[: len(digits) // 2 * 2]  # a file that was cut off may end within a byte
    return bytes.fromhex(whole.decode()) if DIGITS.fullmatch(whole) else data

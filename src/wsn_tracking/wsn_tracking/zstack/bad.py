"""What is returned in the place of a value that cannot be decoded."""

from __future__ import annotations

from typing import NamedTuple


class Bad(NamedTuple):
    """Bytes that are not what they should be: `reason` is the name of a counter, `detail` what was seen."""

    reason: str
    detail: str = ''

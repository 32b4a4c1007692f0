"""The names of everything that is counted on a link, so that a report of them is complete from the start."""

from __future__ import annotations

from wsn_tracking.zstack import dialogue, queues

REJECTED = (
    'unknown_command',
    'malformed',
    'foreign_endpoint',
    'foreign_cluster',
    'payload_length',
    'payload_crc',
    'payload_version',
    'payload_type',
    'payload_direction',
    'line_checksum',
    'line_version',
    'line_field',
)
LINK = (
    'reports',
    'opened',
    'open_failed',
    'attached',
    'lost',
    'pings',
    'pings_missed',
    'found_down',
    'internal_errors',
)


def new_counters() -> dict[str, int]:
    """All at zero."""
    return dict.fromkeys((*LINK, *dialogue.COUNTERS, *REJECTED, *queues.COUNTERS), 0)

"""A recording into a bag."""

from __future__ import annotations

from pathlib import Path

from wsn_tracking.bags.playback import playback
from wsn_tracking.bags.write import BagWriter
from wsn_tracking.sensing.recording import Recording


def save(path: Path | str, recording: Recording) -> None:
    """Write a recording in the order in which the player sends it; log time is the stamp of the epoch."""
    events = playback(recording).events
    with BagWriter(path, recording.metadata) as bag:
        bag.write('anchors', recording.anchors, events[0].stamp_ns if events else 0)
        for event in events:
            bag.write(event.topic, event.value, event.stamp_ns)

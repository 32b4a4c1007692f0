"""A recording into a bag."""

from __future__ import annotations

from pathlib import Path

from wsn_tracking.bags.playback import playback
from wsn_tracking.bags.write import BagWriter
from wsn_tracking.sensing.recording import Recording


def save(path: Path | str, recording: Recording) -> None:
    """Write a recording in the order in which the player sends it; log time is the stamp of the message, never falling.

    Where stamps fall (a looped recording) the log time stands still, since readers sort by it.
    """
    events = playback(recording).events
    log_ns = events[0].stamp_ns if events else 0
    with BagWriter(path, recording.metadata) as bag:
        bag.write('anchors', recording.anchors, log_ns)
        for event in events:
            log_ns = max(log_ns, event.stamp_ns)
            bag.write(event.topic, event.value, log_ns)

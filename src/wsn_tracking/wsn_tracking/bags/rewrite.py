"""A bag recorded through the graph made canonical: equal messages, equal bytes."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

from wsn_tracking.bags.decode import message_of
from wsn_tracking.bags.read import load_metadata, raw_messages, read
from wsn_tracking.bags.types import (
    BASE_TYPES,
    ENTRY_LEVELS,
    expected_type,
    split_topic,
    truth_target,
    typestore,
)
from wsn_tracking.bags.write import BagWriter
from wsn_tracking.errors import TrackingError

# At one instant: the anchors, where the target is, its request, what was heard, and that this was all.
_RANK = {'anchors': 0, 'request': 2, 'trigger_report': 4, 'epoch_end': 5}


def base_topics(entry_level: str) -> frozenset[str]:
    """Relative names of what a replay needs, but for the truth."""
    derived = {level for level in ENTRY_LEVELS if level != entry_level}
    if entry_level != 'range':
        derived.add('trigger_report')
    return frozenset(set(BASE_TYPES) - derived)


def canonical(src: Path | str, dst: Path | str, keep: Collection[str] | None = None) -> None:
    """Rewrite a bag so that equal messages give equal bytes, however they reached the recorder.

    Each message is serialised anew (zero padding); its log time is the stamp of its header, so that nothing
    of the machine that recorded is left; at one stamp the order is anchors, truth (by topic), request, measurements,
    report, end, within a topic as logged. `keep` names the relative topics to keep, by default those that a
    replay needs and the truth. Namespaces, types, metadata and offered quality of service stay.
    """
    recording = read(src)  # refuses what is no bag of ours
    wanted = base_topics(recording.entry_level) if keep is None else frozenset(keep)
    rows = []
    for place, raw in enumerate(raw_messages(src)):
        name = split_topic(raw.topic).name
        is_truth = keep is None and truth_target(name) is not None
        if (name in wanted or is_truth) and raw.type_name == expected_type(name):
            message = message_of(raw.type_name, raw.cdr)
            if message is None:
                raise TrackingError(f'{src}: message {place} on {raw.topic} cannot be decoded; leave the topic out')
            rank = 1 if truth_target(name) is not None else _RANK.get(name, 3)
            stamp = message.header.stamp
            rows.append((stamp.sec * 1_000_000_000 + stamp.nanosec, rank, raw.topic, place, raw, message))
    if not rows:
        raise TrackingError(f'{src} holds none of the topics {sorted(wanted)}: nothing to rewrite')
    rows.sort(key=lambda row: row[:4])
    metadata = {**load_metadata(src), 'entry_level': recording.entry_level}
    with BagWriter(dst, metadata) as writer:
        for stamp_ns, _, _, _, raw, message in rows:
            cdr = bytes(typestore().serialize_cdr(message, raw.type_name, little_endian=True))
            writer.write_raw(raw.topic, raw.type_name, cdr, stamp_ns, raw.qos)

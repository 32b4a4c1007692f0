"""Read a bag: raw for the player, as values for trackers and their judge."""

from __future__ import annotations

import gc
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wsn_tracking.bags.decode import Group, decode
from wsn_tracking.bags.folder import Qos, bag_files, default_qos, parse_qos
from wsn_tracking.bags.messages import PLAIN, anchors_of, plain_values, truth_of
from wsn_tracking.bags.scan import RawLog, in_log_order, scan
from wsn_tracking.bags.select import FLOW, check_definition, entry_level, in_namespace, losses, own_channels
from wsn_tracking.bags.slices import joined
from wsn_tracking.bags.types import truth_target
from wsn_tracking.bags.write import RECORD
from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import Anchors
from wsn_tracking.sensing.recording import Message, Recording, Truth

_KINDS = {type_name: kind for kind, type_name in PLAIN.items()}


class RawMessage(NamedTuple):
    """A message as it was recorded."""

    log_ns: int
    topic: str
    type_name: str
    cdr: bytes
    qos: Qos


def raw_messages(path: Path | str) -> Iterator[RawMessage]:
    """Every intact message of a bag (rosbag2 folder or .mcap file), in the order of the log."""
    log = _load(Path(path))[0]
    known = [(t.topic, t.type_name, parse_qos(t.qos, default_qos(t.topic))) for t in log.topics]
    for at, log_ns, cdr in zip(log.topic_of.tolist(), log.log_ns.tolist(), log.messages.all(), strict=True):
        topic, type_name, qos = known[at]
        yield RawMessage(log_ns, topic, type_name, cdr, qos)


def read(path: Path | str, namespace: str | None = None) -> Recording:
    """Read a bag (rosbag2 folder or .mcap file).

    Topics are known by the last part of their name and by their type; where several namespaces hold them,
    `namespace` says which one is meant. Anchors and truth may also stand in a namespace above. Raises
    TrackingError where there is nothing to track with; whatever else is unusable is counted in `dropped`.
    """
    with _collector_paused():
        return _read(Path(path), namespace)


@contextmanager
def _collector_paused() -> Iterator[None]:
    """No garbage collection: among a million new tuples there is no cycle, yet looking costs a third."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()


def _read(path: Path, namespace: str | None) -> Recording:
    log, metadata = _load(path)
    dropped = Counter(log.dropped)
    topics = own_channels(log, dropped)
    chosen = in_namespace(topics, namespace, path)
    level = entry_level(path, log.topics, metadata, chosen, dropped)
    use = {'request', 'epoch_end', level} | ({'trigger_report'} if level == 'range' else set())
    for row, name in chosen.items():
        if name in FLOW and name not in use:
            dropped['not_entry_level'] += int(np.sum(log.topic_of == row))
    messages = _messages(log, {row: name for row, name in chosen.items() if name in use}, dropped)
    anchors = _anchors(path, log, [row for row, name in chosen.items() if name == 'anchors'], dropped)
    truth = _truths(log, chosen, dropped)
    counts = {reason: count for reason, count in dropped.items() if count}
    return Recording(anchors, level, messages, truth, {**metadata, 'entry_level': level}, counts)


def load_metadata(path: Path | str) -> dict[str, str]:
    """Metadata of a bag alone."""
    return _load(Path(path))[1]


def _load(path: Path) -> tuple[RawLog, dict[str, str]]:
    """All files of a bag as one log, and its metadata."""
    bag = bag_files(path)
    logs = [scan(file) for file in bag.files]
    dropped = Counter(bag.dropped)
    metadata: dict[str, str] = {}
    offset, indices = 0, []
    for log in logs:
        dropped.update(log.dropped)
        metadata.update(log.metadata.get(RECORD, {}))
        indices.append(log.topic_of + offset)
        offset += len(log.topics)
    metadata.update(bag.custom)
    whole = RawLog(
        tuple(topic for log in logs for topic in log.topics),
        np.concatenate(indices),
        np.concatenate([log.log_ns for log in logs]),
        logs[0].messages if len(logs) == 1 else joined([log.messages for log in logs]),
        {},
        dict(dropped),
    )
    return in_log_order(whole), metadata


def _decode(log: RawLog, row: int, dropped: Counter[str]) -> tuple[NDArray[np.int64], list[Group]]:
    check_definition(log.topics[row])
    at = np.flatnonzero(log.topic_of == row)
    groups, bad = decode(log.topics[row].type_name, log.messages.select(at))
    dropped['undecodable'] += bad
    return at, groups


def _messages(log: RawLog, rows: Mapping[int, str], dropped: Counter[str]) -> tuple[Message, ...]:
    place = np.empty(log.topic_of.size, dtype=object)
    filled = np.zeros(log.topic_of.size, dtype=np.bool_)
    for row in rows:
        kind = _KINDS[log.topics[row].type_name]
        at, groups = _decode(log, row, dropped)
        for group in groups:
            values = plain_values(kind, group.columns)
            place[at[group.rows]] = np.fromiter(values, dtype=object, count=group.rows.size)
            filled[at[group.rows]] = True
    return tuple(place[filled].tolist())


def _anchors(path: Path, log: RawLog, rows: list[int], dropped: Counter[str]) -> Anchors:
    """The last table in the log."""
    last: tuple[int, Mapping[str, Any]] | None = None
    for row in rows:
        at, groups = _decode(log, row, dropped)
        for group in groups:
            k = int(np.argmax(group.rows))
            if last is None or at[group.rows[k]] > last[0]:
                last = int(at[group.rows[k]]), {name: [cells[k]] for name, cells in group.columns.items()}
    if last is None:
        raise TrackingError(
            f'{path} holds no anchors: positions of the nodes are expected on topic anchors{losses(dropped)}'
        )
    return anchors_of(last[1])


def _truths(log: RawLog, chosen: Mapping[int, str], dropped: Counter[str]) -> dict[int, Truth]:
    parts: dict[int, list[dict[str, Any]]] = {}
    for row, name in chosen.items():
        target = truth_target(name)
        if target is not None:
            columns = [group.columns for group in _decode(log, row, dropped)[1]]
            parts.setdefault(target, []).extend(columns)
    truths = {}
    for target, columns in sorted(parts.items()):
        if columns:
            merged = {name: np.concatenate([part[name] for part in columns]) for name in columns[0]}
            truths[target], lost = truth_of(target, merged)
            dropped['truth_unusable'] += lost
    return {target: truth for target, truth in truths.items() if truth.stamps_ns.size}

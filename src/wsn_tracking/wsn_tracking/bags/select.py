"""Which channels of a bag are ours, and whether they hold what we expect."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from rosbags.typesys import TypesysError, get_types_from_idl, get_types_from_msg

from wsn_tracking.bags.scan import RawLog, RawTopic
from wsn_tracking.bags.types import (
    BASE_TYPES,
    ENTRY_LEVELS,
    definition,
    expected_type,
    split_topic,
    truth_target,
    typestore,
)
from wsn_tracking.errors import TrackingError

FLOW = ('request', *ENTRY_LEVELS, 'epoch_end', 'trigger_report')  # what a tracker hears, epoch by epoch


def own_channels(log: RawLog, dropped: Counter[str]) -> dict[int, tuple[str, str]]:
    """Rows of `log.topics` that are ours: (namespace, relative name)."""
    ours = {}
    for row, raw in enumerate(log.topics):
        namespace, name = split_topic(raw.topic)
        if name not in BASE_TYPES and truth_target(name) is None:
            continue
        if raw.type_name != expected_type(name):
            dropped['wrong_type'] += int(np.sum(log.topic_of == row))
            continue
        ours[row] = (namespace, name)
    return ours


def in_namespace(topics: Mapping[int, tuple[str, str]], wanted: str | None, path: Path) -> dict[int, str]:
    """Rows of the one namespace that is read, by relative name."""
    flows = sorted({namespace for namespace, name in topics.values() if name in FLOW})
    if wanted is None and len(flows) > 1:
        shown = ['/' + namespace for namespace in flows]
        raise TrackingError(f'{path} holds measurements in several namespaces {shown}: name one (`namespace`)')
    chosen = wanted.strip('/') if wanted is not None else (flows[0] if flows else '')
    if wanted is not None and chosen not in flows:
        raise TrackingError(f'{path} has nothing in namespace {wanted!r}; it holds {["/" + f for f in flows]}')
    above = [chosen]
    while above[-1]:
        above.append(above[-1].rpartition('/')[0])
    rows: dict[int, str] = {}
    for name in {name for _, name in topics.values()}:
        homes = [chosen] if name in FLOW else above
        present = [home for home in homes if (home, name) in topics.values()]
        rows.update({row: name for row, key in topics.items() if present and key == (present[0], name)})
    if not flows and not rows:  # truth or anchors alone, in any namespace: entry_level tells what is missing
        rows = {row: name for row, (_, name) in topics.items()}
    return dict(sorted(rows.items()))


def entry_level(
    path: Path,
    topics: Sequence[RawTopic],
    metadata: Mapping[str, str],
    chosen: Mapping[int, str],
    dropped: Mapping[str, int],
) -> str:
    """The level that the metadata name, else the first of ENTRY_LEVELS that has a topic."""
    said = metadata.get('entry_level')
    if said is not None and said not in ENTRY_LEVELS:
        raise TrackingError(f'{path} says entry_level {said!r}: expected one of {", ".join(ENTRY_LEVELS)}')
    present = [level for level in ENTRY_LEVELS if level in chosen.values()]
    flow = any(name in FLOW for name in chosen.values())
    if (said is None and not present) or not flow:
        seen = sorted(ascii(f'{raw.topic} ({raw.type_name})')[1:-1] for raw in topics)[:8]
        raise TrackingError(
            f'{path} holds no measurements: a topic rssi, range or observation of wsn_tracking_msgs is '
            f'expected, seen were {", ".join(seen) or "no topics"}{losses(dropped)}'
        )
    return said or present[0]


def losses(dropped: Mapping[str, int]) -> str:
    """What an error adds where a bag is not whole: that may be the reason."""
    counts = ', '.join(f'{reason} {count}' for reason, count in sorted(dropped.items()) if count)
    return f'; not read: {counts}' if counts else ''


def check_definition(raw: RawTopic) -> None:
    """Raise where the bag's own definition of a type has other fields than ours."""
    if not raw.definition or raw.definition == definition(raw.type_name):
        return
    parse = get_types_from_idl if raw.encoding in ('ros2idl', 'omgidl') else None
    try:
        types = parse(raw.definition) if parse else get_types_from_msg(raw.definition, raw.type_name)
    except (TypesysError, ValueError, IndexError, KeyError, AssertionError, RecursionError) as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise TrackingError(f'the definition of {raw.type_name} in the bag cannot be read: {reason}') from error
    ours = typestore().fielddefs
    for name, (_, fields) in types.items():
        if name not in ours or [*fields] != [*ours[name][1]]:
            expected = [field for field, _ in ours[name][1]] if name in ours else 'no such type'
            raise TrackingError(
                f'{name} has the fields {[field for field, _ in fields]} in the bag (topic {raw.topic!r}), '
                f'expected {expected}, of equal types: it was recorded with another version of the messages'
            )
    if raw.type_name not in types:
        raise TrackingError(f'the definition of {raw.type_name} in the bag describes {sorted(types)} instead')

"""What a bag holds, for human eyes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping

import numpy as np

from wsn_tracking.bags.epochs import with_epoch_ends
from wsn_tracking.sensing.recording import Recording, Truth
from wsn_tracking.sensing.values import EpochEnd, Range, RangeBearing, Request, Rssi


def describe(recording: Recording) -> str:
    """A table: entry level, anchors, duration, epochs and rate of each target, truth, metadata, losses."""
    rows = [
        ('entry level', recording.entry_level),
        ('anchors', _anchors(recording)),
        ('duration', _duration(recording)),
        *_targets(recording),
        *((f'truth {target}', _truth(truth)) for target, truth in sorted(recording.truth.items())),
    ]
    rows += [(name, text) for name, text in sorted(recording.metadata.items()) if name != 'entry_level']
    rows.append(('dropped', _counts(recording.dropped)))
    width = max(len(name) for name, _ in rows)
    return '\n'.join(f'{name:<{width}}  {text}' for name, text in rows)


def _anchors(recording: Recording) -> str:
    table = recording.anchors
    low, high = table.positions.min(axis=0), table.positions.max(axis=0)
    return f'{table.ids.size} ({_ids(table.ids.tolist())}), {_box(low, high)}'


def _ids(ids: list[int]) -> str:
    shown = ' '.join(str(i) for i in ids[:16])
    return shown + (' ...' if len(ids) > 16 else '')


def _box(low: Iterable[float], high: Iterable[float]) -> str:
    sides = ', '.join(f'{axis} {a:.2f}..{b:.2f}' for axis, a, b in zip('xyz', low, high, strict=True))
    return f'{sides} m'


def _duration(recording: Recording) -> str:
    stamps = [message.stamp_ns for message in recording.messages]
    return f'{(max(stamps) - min(stamps)) / 1e9:.1f} s' if stamps else 'no messages'


def _targets(recording: Recording) -> list[tuple[str, str]]:
    messages = with_epoch_ends(recording).messages
    ends = Counter(m.target_id for m in messages if isinstance(m, EpochEnd))
    heard = Counter(m.target_id for m in messages if isinstance(m, Rssi | Range | RangeBearing))
    nodes: dict[int, set[int]] = {target: set() for target in ends}
    for message in messages:
        if isinstance(message, Rssi | Range | RangeBearing):
            nodes.setdefault(message.target_id, set()).add(message.node_id)
    rows = []
    for target in sorted(nodes):
        stamps = np.array([m.stamp_ns for m in messages if isinstance(m, Request) and m.target_id == target])
        gaps = np.diff(stamps)
        rate = f', every {np.median(gaps) / 1e9:.3f} s' if gaps.size else ''
        text = f'{ends[target]} epochs{rate}, {heard[target]} measurements of {len(nodes[target])} nodes'
        rows.append((f'target {target}', text))
    return rows


def _truth(truth: Truth) -> str:
    box = _box(truth.positions.min(axis=0), truth.positions.max(axis=0))
    seconds = (truth.stamps_ns[-1] - truth.stamps_ns[0]) / 1e9
    return f'{truth.stamps_ns.size} positions over {seconds:.1f} s, {box}'


def _counts(counts: Mapping[str, int]) -> str:
    return ', '.join(f'{reason} {count}' for reason, count in sorted(counts.items())) or 'nothing'

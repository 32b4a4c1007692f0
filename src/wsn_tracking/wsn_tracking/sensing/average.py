"""Several packets of one node within an epoch become one measurement."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TypeVar

from wsn_tracking.sensing.values import Measurement, Range, RangeBearing, Rssi

Value = TypeVar('Value', Rssi, Range, RangeBearing)


def one_a_node(packets: Iterable[Measurement]) -> tuple[Measurement, ...]:
    """At most one measurement a node, ascending by node id, whatever the order of arrival."""
    by_node: dict[int, list[Measurement]] = {}
    for packet in sorted(packets, key=lambda p: (p.node_id, p.seq)):
        by_node.setdefault(packet.node_id, []).append(packet)
    return tuple(same[0] if len(same) == 1 else _average(same) for same in by_node.values())


def _average(packets: Sequence[Measurement]) -> Measurement:
    first = packets[0]
    if isinstance(first, Rssi):
        return _average_rssi([p for p in packets if isinstance(p, Rssi)])
    if isinstance(first, Range):
        return _average_range([p for p in packets if isinstance(p, Range)])
    return packets[-1]  # a bearing has no mean worth the name: the latest counts


def _average_rssi(packets: Sequence[Rssi]) -> Rssi:
    weights = [p.n_samples for p in packets]
    return packets[-1]._replace(
        rssi_dbm=_mean([p.rssi_dbm for p in packets], weights),
        sigma_db=_mean_std([p.sigma_db for p in packets], weights),
        n_samples=sum(weights),
    )


def _average_range(packets: Sequence[Range]) -> Range:
    weights = [p.n_samples for p in packets]
    return packets[-1]._replace(
        range=_mean([p.range for p in packets], weights),
        variance=_mean_std([math.sqrt(p.variance) for p in packets], weights) ** 2,
        rssi_dbm=_mean([p.rssi_dbm for p in packets], weights),
        n_samples=sum(weights),
    )


def _mean(values: Sequence[float], weights: Sequence[int]) -> float:
    return math.fsum(w * v for w, v in zip(weights, values, strict=True)) / sum(weights)


def _mean_std(stds: Sequence[float], weights: Sequence[int]) -> float:
    """Standard deviation of a weighted mean of independent values."""
    return math.sqrt(math.fsum((w * s) ** 2 for w, s in zip(weights, stds, strict=True))) / sum(weights)

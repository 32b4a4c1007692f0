"""Several packets of one node within an epoch become one measurement."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from wsn_tracking.sensing.values import NAN, Epoch, Measurement, Modality, Range, RangeBearing, Rssi

USABLE_DBM = (-127.0, 20.0)  # what a receiver can say; +127 and -128 are how radios spell `no value`
USABLE_M = (1e-6, 1e5)  # no reading is so short, and no radio of a sensor network reaches so far
USABLE_STD = (1e-6, 1e6)  # [dB, m] no reading is so sure, and one with a larger deviation says nothing


def usable(packet: Measurement) -> bool:
    """Whether the number can be true at all: a signal strength that radios can say, a positive finite range.

    A deviation may be unknown (NaN), but not zero or nearly so, negative or infinite. What a bearing lacks is NaN, a
    value too.
    """
    if isinstance(packet, Rssi):
        in_range = USABLE_DBM[0] <= packet.rssi_dbm <= USABLE_DBM[1]
        return in_range and (math.isnan(packet.sigma_db) or USABLE_STD[0] <= packet.sigma_db < USABLE_STD[1])
    if isinstance(packet, Range):
        in_range = USABLE_M[0] <= packet.range < USABLE_M[1]
        return in_range and (math.isnan(packet.variance) or USABLE_STD[0] ** 2 <= packet.variance < USABLE_STD[1] ** 2)
    return True


def unusable(packets: Iterable[Measurement]) -> int:
    """How many of the packets cannot be true."""
    return sum(not usable(packet) for packet in packets)


def one_a_node(packets: Iterable[Measurement]) -> tuple[Measurement, ...]:
    """At most one measurement a node, ascending by node id, whatever the order of arrival.

    The mean of a node's usable packets; where none is usable, its last one, for whoever reads it to refuse.
    """
    by_node: dict[int, list[Measurement]] = {}
    for packet in sorted(packets, key=lambda p: (p.node_id, p.seq)):
        by_node.setdefault(packet.node_id, []).append(packet)
    return tuple(_one(same) for same in by_node.values())


def without_bearings(epoch: Epoch) -> Epoch:
    """The epoch for a tracker of ranges: of what has arrived of range and bearing, the range counts."""
    if not any(isinstance(p, RangeBearing) for p in epoch.measurements):
        return epoch
    ranges = (_range_of(p) if isinstance(p, RangeBearing) else p for p in epoch.measurements if _has_arrived(p))
    return epoch._replace(measurements=tuple(ranges))


def _has_arrived(packet: Measurement) -> bool:
    return not isinstance(packet, RangeBearing) or (packet.arrived and not math.isnan(packet.range))


def _range_of(packet: RangeBearing) -> Range:
    variance = packet.covariance[0]
    told = variance if USABLE_STD[0] ** 2 <= variance < USABLE_STD[1] ** 2 else NAN
    head = packet.stamp_ns, packet.node_id, packet.target_id, packet.seq, packet.request_seq
    return Range(*head, Modality.OTHER, packet.range, told)


def _one(same: Sequence[Measurement]) -> Measurement:
    last = same[-1]
    if len(same) == 1:
        return last
    packets = [p for p in same if usable(p)] or same[-1:]
    last = packets[-1]
    if len(packets) == 1:
        return last
    if isinstance(last, Rssi):
        return _average_rssi([p for p in packets if isinstance(p, Rssi)])
    if isinstance(last, Range):
        return _average_range([p for p in packets if isinstance(p, Range)])
    # a bearing has no mean worth the name: the latest that arrived counts
    return max((p for p in packets if isinstance(p, RangeBearing)), key=lambda p: (p.arrived, p.seq))


def _average_rssi(packets: Sequence[Rssi]) -> Rssi:
    weights = _weights(packets)
    return packets[-1]._replace(
        rssi_dbm=_mean([p.rssi_dbm for p in packets], weights),
        sigma_db=_std_of_mean([p.sigma_db for p in packets], weights),
        n_samples=sum(weights),
    )


def _average_range(packets: Sequence[Range]) -> Range:
    weights = _weights(packets)
    return packets[-1]._replace(
        range=_mean([p.range for p in packets], weights),
        variance=_std_of_mean([math.sqrt(p.variance) for p in packets], weights) ** 2,
        rssi_dbm=_mean([p.rssi_dbm if math.isfinite(p.rssi_dbm) else NAN for p in packets], weights),
        n_samples=sum(weights),
    )


def _weights(packets: Sequence[Rssi | Range]) -> list[int]:
    return [max(p.n_samples, 1) for p in packets]


def _mean(values: Sequence[float], weights: Sequence[int]) -> float:
    return math.fsum(w * v for w, v in zip(weights, values, strict=True)) / sum(weights)


def _std_of_mean(stds: Sequence[float], weights: Sequence[int]) -> float:
    """Standard deviation of a weighted mean of independent values; NaN where that of one of them is not known."""
    return math.sqrt(math.fsum((w * s) ** 2 for w, s in zip(weights, stds, strict=True))) / sum(weights)

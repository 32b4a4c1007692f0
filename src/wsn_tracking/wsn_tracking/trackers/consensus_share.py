"""What nodes of system B tell each other: plain values, so that nothing of one node's memory reaches another."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import NamedTuple

from wsn_tracking.errors import TrackingError

STATES = 4
ROW = STATES + STATES * (STATES + 1) // 2  # numbers of an information vector and an upper triangle
LIKE = {'icf': ('icf', 'chebyshev'), 'chebyshev': ('chebyshev', 'icf')}  # schemes that average the same thing


class Share(NamedTuple):
    """One node's broadcast in one round (ConsensusShare.msg, field by field)."""

    stamp_ns: int
    target_id: int
    request_seq: int
    round: int
    node_id: int
    scheme: str
    degree: int  # neighbours that the node counts, frozen within an epoch
    live: bytes  # bitmap of the nodes known to be alive, least significant bit first
    information_vector: tuple[float, ...] = ()
    information: tuple[float, ...] = ()  # upper triangle, row by row
    item_ids: tuple[int, ...] = ()  # flood: whose items follow
    items: tuple[float, ...] = ()  # flood: vector and triangle of each item, one after another


def check_share(share: Share, scheme: str) -> Share:
    """Itself, or TrackingError where a node that runs this scheme may not use it."""
    if share.scheme not in LIKE.get(scheme, (scheme,)):
        _refuse(share, f'is of scheme {share.scheme!r}, expected {scheme!r}: configure all nodes alike')
    seen = len(share.information_vector), len(share.information), len(share.items)
    expected = (0, 0, ROW * len(share.item_ids)) if scheme == 'flood' else (STATES, ROW - STATES, 0)
    if seen != expected:
        _refuse(share, f'has {seen} numbers in vector, triangle and items, expected {expected}')
    if not math.isfinite(sum(share.information_vector) + sum(share.information) + sum(share.items)):
        _refuse(share, 'holds NaN or infinity: expected finite numbers')
    return share


def _refuse(share: Share, why: str) -> None:
    raise TrackingError(f'share of node {share.node_id}, epoch {share.request_seq}, round {share.round} {why}')


def bitmap(ids: Iterable[int]) -> int:
    """The set of ids as one integer."""
    bits = 0
    for i in ids:
        bits |= 1 << i
    return bits


def to_bytes(bits: int) -> bytes:
    """A bitmap as it is sent, no longer than it must be."""
    return bits.to_bytes((bits.bit_length() + 7) // 8, 'little')


def ids_of(bits: int) -> tuple[int, ...]:
    """The ids of a bitmap, ascending."""
    return tuple(i for i, bit in enumerate(bin(bits)[:1:-1]) if bit == '1')

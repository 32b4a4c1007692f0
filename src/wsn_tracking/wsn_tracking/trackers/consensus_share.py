"""What nodes of system B tell each other: plain values, so that nothing of one node's memory reaches another."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

STATES = 4
ROW = STATES + STATES * (STATES + 1) // 2  # numbers of an information vector and an upper triangle


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

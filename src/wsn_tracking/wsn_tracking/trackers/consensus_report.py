"""How nodes of system B came out of an epoch, for those who look on."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple


class Outcome(NamedTuple):
    """One node after an epoch."""

    node_id: int
    arrival_probability: float  # mu: that its own observation arrived
    disagreement: float  # how far its position moved in the last round [m]; NaN: it cannot tell
    live: tuple[int, ...]  # whom it knows to be alive, itself included, ascending
    used: tuple[int, ...]  # neighbours of whom it used a share, ascending


class ConsensusReport(NamedTuple):
    """ConsensusReport.msg, field by field; the first arrays in the order of `node_ids`."""

    stamp_ns: int
    target_id: int
    request_seq: int
    node_ids: tuple[int, ...]
    arrival_probabilities: tuple[float, ...]
    disagreements: tuple[float, ...]
    live: tuple[int, ...]  # how many each knows to be alive
    components: tuple[int, ...]  # the lowest id among them: the same for nodes that can reach each other
    link_senders: tuple[int, ...]  # whose shares were used ...
    link_receivers: tuple[int, ...]  # ... by whom


def report_of(stamp_ns: int, target_id: int, request_seq: int, outcomes: Iterable[Outcome]) -> ConsensusReport:
    """One report of several nodes, ascending by id."""
    nodes = sorted(outcomes)
    return ConsensusReport(
        stamp_ns,
        target_id,
        request_seq,
        tuple(node.node_id for node in nodes),
        tuple(node.arrival_probability for node in nodes),
        tuple(node.disagreement for node in nodes),
        tuple(len(node.live) for node in nodes),
        tuple(node.live[0] for node in nodes),
        tuple(sender for node in nodes for sender in node.used),
        tuple(node.node_id for node in nodes for _ in node.used),
    )

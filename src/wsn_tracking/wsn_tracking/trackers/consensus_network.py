"""Several nodes of system B in one process, in lockstep: what a network does in which nothing is late."""

from __future__ import annotations

from collections.abc import Mapping

from wsn_tracking.sensing.values import Epoch
from wsn_tracking.trackers.consensus_node import ConsensusNode
from wsn_tracking.trackers.consensus_share import Share
from wsn_tracking.trackers.estimate import Estimate


def run_epoch(nodes: Mapping[int, ConsensusNode], epochs: Mapping[int, Epoch]) -> dict[int, Estimate]:
    """One epoch of the nodes in `epochs`, by id; a node that is not among them says nothing."""
    said = {i: nodes[i].begin(epoch) for i, epoch in epochs.items()}
    while any(share is not None for share in said.values()):
        _deliver(nodes, {i: share for i, share in said.items() if share is not None})
        said = {i: nodes[i].advance() for i in said}
    return {i: nodes[i].finish() for i in said}


def _deliver(nodes: Mapping[int, ConsensusNode], shares: Mapping[int, Share]) -> None:
    for sender, share in shares.items():
        for i in nodes[sender].neighbours:
            if i in shares:
                nodes[i].take(share)

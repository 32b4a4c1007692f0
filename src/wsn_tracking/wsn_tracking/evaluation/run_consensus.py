"""A recording through system B without any middleware: what its nodes compute, share by share."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

from wsn_tracking.evaluation.run import Progress, Run, Span, silent, told, watched_epochs
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.trackers.consensus_config import ConsensusConfig
from wsn_tracking.trackers.consensus_network import run_epoch
from wsn_tracking.trackers.consensus_node import ConsensusNode
from wsn_tracking.trackers.estimate import Estimate


def run_consensus(
    recording: Recording,
    config: ConsensusConfig,
    target_id: int = -1,
    dead: Mapping[int, int] | None = None,
    progress: Progress = silent,
) -> Run:
    """Every node's estimates, `consensus_<id>`; `dead`: from which epoch on (request_seq) a node says nothing."""
    ids = recording.anchors.ids.tolist()
    nodes = {i: ConsensusNode(config, recording.anchors, i) for i in ids}
    estimates: dict[str, list[Estimate]] = {f'consensus_{i}': [] for i in ids}
    counters: Counter[str] = Counter(recording.dropped)
    spans: dict[int, Span] = {}

    def anew() -> None:
        for node in nodes.values():
            node.reset()

    for epoch in watched_epochs(recording, target_id, counters, spans, anew, progress):
        living = [i for i in ids if dead is None or i not in dead or epoch.request_seq < dead[i]]
        for estimate in run_epoch(nodes, dict.fromkeys(living, epoch)).values():
            estimates[estimate.source].append(estimate)
    for node in nodes.values():
        counters.update(node.counters)
    return Run({name: tuple(e) for name, e in estimates.items() if e}, (), spans, told(counters))

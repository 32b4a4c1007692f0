"""A scenario as a recording: what its radios would have said, and where the target was."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wsn_tracking.models.anchors import Floats
from wsn_tracking.sensing.recording import Message, Recording, Truth
from wsn_tracking.sensing.values import EpochEnd, Request
from wsn_tracking.simulation.scenario import Scenario

START_NS = 1_500_000_000_000_000_000  # stamps of a simulation are its own, and repeatable
TARGET = 1  # the first one


def record(scenario: Scenario, seed: int, start_ns: int = START_NS) -> Recording:
    """Every epoch of the scenario at its entry level; equal seeds give equal recordings."""
    stamps = start_ns + np.round(np.arange(len(scenario.truth)) * scenario.period * 1e9).astype(np.int64)
    walks = {TARGET + i: walk for i, walk in enumerate((scenario.truth, *scenario.companions))}
    messages: list[Message] = []
    feeds = [
        scenario.packets(scenario._replace(truth=walk), seed, target, stamps.tolist()) for target, walk in walks.items()
    ]
    for k, (stamp, *epochs) in enumerate(zip(stamps.tolist(), *feeds, strict=True)):
        for target, packets in zip(walks, epochs, strict=True):
            messages.append(Request(stamp, target, k))
            messages.extend(packets)
            sent = tuple(p.node_id for p in packets), tuple(p.seq for p in packets)
            messages.append(EpochEnd(stamp, target, k, scenario.entry_level, *sent, final=k == len(stamps) - 1))
    truth = {target: _truth(target, stamps, walk) for target, walk in walks.items()}
    metadata = {
        'entry_level': scenario.entry_level,
        'scenario': scenario.name,
        'seed': str(seed),
        'configuration': scenario.configuration,
        'area': ' '.join(f'{edge:g}' for edge in scenario.area),
        'target_height': '0',
        'period': f'{scenario.period:g}',
    }
    return Recording(scenario.anchors, scenario.entry_level, tuple(messages), truth, metadata, {})


def _truth(target: int, stamps: NDArray[np.int64], walk: Floats) -> Truth:
    height = np.zeros(len(stamps))
    return Truth(target, stamps, np.column_stack([walk[:, :2], height]), np.column_stack([walk[:, 2:], height]))

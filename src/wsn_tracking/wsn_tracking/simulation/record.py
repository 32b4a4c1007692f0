"""A scenario as a recording: what its radios would have said, and where the target was."""

from __future__ import annotations

import numpy as np

from wsn_tracking.sensing.recording import Message, Recording, Truth
from wsn_tracking.sensing.values import EpochEnd, Request
from wsn_tracking.simulation.scenario import Scenario

START_NS = 1_500_000_000_000_000_000  # stamps of a simulation are its own, and repeatable
TARGET = 1


def record(scenario: Scenario, seed: int, start_ns: int = START_NS) -> Recording:
    """Every epoch of the scenario at its entry level; equal seeds give equal recordings."""
    stamps = start_ns + np.round(np.arange(len(scenario.truth)) * scenario.period * 1e9).astype(np.int64)
    messages: list[Message] = []
    epochs = scenario.packets(scenario, seed, TARGET, stamps.tolist())
    for k, (stamp, packets) in enumerate(zip(stamps.tolist(), epochs, strict=True)):
        messages.append(Request(stamp, TARGET, k))
        messages.extend(packets)
        sent = tuple(p.node_id for p in packets), tuple(p.seq for p in packets)
        messages.append(EpochEnd(stamp, TARGET, k, scenario.entry_level, *sent, final=k == len(stamps) - 1))
    height = np.zeros(len(stamps))
    truth = Truth(
        TARGET,
        stamps,
        np.column_stack([scenario.truth[:, :2], height]),
        np.column_stack([scenario.truth[:, 2:], height]),
    )
    metadata = {
        'entry_level': scenario.entry_level,
        'scenario': scenario.name,
        'seed': str(seed),
        'configuration': scenario.configuration,
        'area': ' '.join(f'{edge:g}' for edge in scenario.area),
        'target_height': '0',
        'period': f'{scenario.period:g}',
    }
    return Recording(scenario.anchors, scenario.entry_level, tuple(messages), {TARGET: truth}, metadata, {})

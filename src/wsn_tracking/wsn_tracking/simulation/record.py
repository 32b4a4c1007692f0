"""A scenario as a recording: what its radios would have said, and where the target was."""

from __future__ import annotations

import numpy as np

from wsn_tracking.sensing.recording import Message, Recording, Truth
from wsn_tracking.sensing.values import EpochEnd, Request, Rssi
from wsn_tracking.simulation.scenarios import Scenario
from wsn_tracking.simulation.world import rssi_of_epoch

START_NS = 1_500_000_000_000_000_000  # stamps of a simulation are its own, and repeatable
TARGET = 1


def record(scenario: Scenario, seed: int, start_ns: int = START_NS) -> Recording:
    """Every epoch of the scenario at entry level rssi; equal seeds give equal recordings."""
    ids = tuple(scenario.anchors.ids.tolist())
    stamps = start_ns + np.round(np.arange(len(scenario.truth)) * scenario.period * 1e9).astype(np.int64)
    messages: list[Message] = []
    for k, stamp in enumerate(stamps.tolist()):
        rssi = rssi_of_epoch(scenario, k, seed).tolist()
        messages.append(Request(stamp, TARGET, k))
        messages.extend(Rssi(stamp, node, TARGET, k, k, dbm) for node, dbm in zip(ids, rssi, strict=True))
        final = k == len(stamps) - 1
        messages.append(EpochEnd(stamp, TARGET, k, 'rssi', ids, (k,) * len(ids), final))
    height = np.zeros(len(stamps))
    truth = Truth(
        TARGET,
        stamps,
        np.column_stack([scenario.truth[:, :2], height]),
        np.column_stack([scenario.truth[:, 2:], height]),
    )
    metadata = {
        'entry_level': 'rssi',
        'scenario': scenario.name,
        'seed': str(seed),
        'configuration': scenario.configuration,
        'area': ' '.join(f'{edge:g}' for edge in scenario.area),
        'target_height': '0',
        'period': f'{scenario.period:g}',
    }
    return Recording(scenario.anchors, 'rssi', tuple(messages), {TARGET: truth}, metadata, {})

"""Estimates that were recorded, and where two records of them differ."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from wsn_tracking.bags.decode import decode
from wsn_tracking.bags.messages import estimates_of
from wsn_tracking.bags.read import raw_messages
from wsn_tracking.bags.types import ESTIMATE, split_topic
from wsn_tracking.errors import TrackingError
from wsn_tracking.trackers.estimate import Estimate


def read_estimates(bag: Path | str) -> dict[str, list[Estimate]]:
    """Estimates in a bag by output, in the order of the log."""
    by_output: dict[str, list[bytes]] = {}
    for raw in raw_messages(bag):
        if raw.type_name == ESTIMATE:
            by_output.setdefault(split_topic(raw.topic).name.removeprefix('estimate/'), []).append(raw.cdr)
    return {name: _decoded(name, cdrs) for name, cdrs in by_output.items()}


def _decoded(name: str, cdrs: list[bytes]) -> list[Estimate]:
    groups, bad = decode(ESTIMATE, cdrs)
    if bad:
        raise TrackingError(f'{bad} of {len(cdrs)} estimates of {name} cannot be decoded: record them again')
    found: dict[int, Estimate] = {}
    for group in groups:
        found.update(zip(group.rows.tolist(), estimates_of(group.columns), strict=True))
    return [found[row] for row in range(len(cdrs))]


def differences(one: Sequence[Estimate], other: Sequence[Estimate]) -> list[str]:
    """Where two sequences of estimates differ in any number, bit for bit; empty: nowhere."""
    found = [] if len(one) == len(other) else [f'{len(one)} estimates against {len(other)}']
    for a, b in zip(one, other, strict=False):
        for field in Estimate._fields:
            left, right = getattr(a, field), getattr(b, field)
            if not np.array_equal(left, right, equal_nan=field in {'q', 'covariance'}):
                found.append(f'epoch {a.request_seq} of {a.source}: {field} {left} != {right}')
    return found

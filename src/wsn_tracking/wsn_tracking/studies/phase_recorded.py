"""Two robots in phase, as a bag has recorded them: where they were, where they were seen, and the error in phase."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from wsn_tracking.bags.estimates import read_estimates
from wsn_tracking.bags.read import read
from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation.interpolation import truth_at
from wsn_tracking.models.anchors import Floats
from wsn_tracking.sensing.recording import Truth
from wsn_tracking.simulation.driven import FIRST, SECOND, FollowConfig, phase_error
from wsn_tracking.studies.phase_runs import PhaseRun
from wsn_tracking.trackers.estimate import Estimate, Kind


def phase_run(bag: Path | str, follow: FollowConfig) -> PhaseRun:
    """A run of both robots at the instants of the first one's truth; TrackingError where the bag holds no such run."""
    truth, estimates = read(bag).truth, read_estimates(bag)
    outputs = {target: estimates.get(f'hybrid_target_{target}', []) for target in (FIRST, SECOND)}
    if not (truth.keys() >= outputs.keys() and all(outputs.values())):
        raise TrackingError(
            f'{bag} holds the truth of targets {sorted(truth)} and estimates {sorted(estimates)}: expected both of '
            f'targets {FIRST} and {SECOND}, of the hybrid tracker, as `python -m wsn_tracking.follower` records them'
        )
    stamps = truth[FIRST].stamps_ns
    states = np.stack([_states(truth[target], stamps) for target in outputs])
    seen = np.stack([_seen(output, stamps) for output in outputs.values()])
    error = phase_error(follow, states[0, :, :2], states[1, :, :2])
    return PhaseRun((stamps - stamps[0]) * 1e-9, states, seen, error)


def _states(truth: Truth, stamps: NDArray[np.int64]) -> Floats:
    """Position and velocity (K, 4) at these stamps."""
    planar = np.column_stack([truth.velocities[:, :2], np.zeros(len(truth.stamps_ns))])  # robots: none upwards is told
    velocities = truth._replace(positions=planar)
    return np.concatenate([truth_at(t, stamps).positions[:, :2] for t in (truth, velocities)], axis=-1)


def _seen(estimates: Sequence[Estimate], stamps: NDArray[np.int64]) -> Floats:
    """Estimated positions (K, 2) at these stamps; NaN before the target was found and after the last of them."""
    found = [e for e in estimates if e.kind != Kind.START]
    if not found:
        return np.full((len(stamps), 2), np.nan)
    first = int(stamps[0])
    t = np.array([(e.stamp_ns - first) * 1e-9 for e in found])
    x = np.array([e.mean[:2] for e in found])
    wanted = (stamps - first) * 1e-9
    return np.stack([np.interp(wanted, t, x[:, i], left=np.nan, right=np.nan) for i in range(2)], axis=-1)

"""System C over many runs at once: people walk, nodes hear them, filters track them, errors are scored.

Filters are compared over the same `Walks`, so that their difference is theirs alone.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wsn_tracking.filters.ancestry import Ancestry
from wsn_tracking.models.anchors import Anchors, Floats, Mask
from wsn_tracking.models.body_likelihood import Readings
from wsn_tracking.models.walk import PLANAR
from wsn_tracking.simulation.c_body import BodyConfig, hear, nodes, people
from wsn_tracking.simulation.paths import Area
from wsn_tracking.trackers.human_config import HumanConfig
from wsn_tracking.trackers.human_filter import HumanFilter
from wsn_tracking.trackers.human_models import curves_of

BLOCK = 20  # runs that are tracked at a time: a start weighs ten thousand places in each
SETTLED = 10.0  # [s] that are not scored: filters that start anywhere have found him by then, or will not soon


class Walks(NamedTuple):
    """What happened in every run."""

    anchors: Anchors
    area: Area
    times: Floats  # (K,) [s]
    states: Floats  # (runs, K, 4)
    z: Floats  # (runs, K, N) [dBm]; NaN: not heard


class Tracks(NamedTuple):
    """What a filter made of it."""

    mean: Floats  # (runs, K, 4)
    covariance: Floats  # (runs, K, 4, 4)
    reset: Mask  # (runs, K)
    by_node: Floats  # (runs, K, N) log evidence, where asked for


def sample(config: BodyConfig, runs: int, seed: int) -> Walks:
    """Draw runs."""
    generator = np.random.default_rng(seed)
    anchors, t = nodes(config), config.times
    walked = people(config, runs, generator)
    z = [
        hear(config, anchors, walked.states[:, k, :2], walked.facing[:, k], float(t[k]), generator)
        for k in range(t.size)
    ]
    return Walks(anchors, config.area, t, walked.states, np.stack(z, axis=1))


def track(config: HumanConfig, walks: Walks, seed: int = 1, *, nodes_too: bool = False) -> Tracks:
    """Every run through all epochs; with `lag`, the estimates of that long ago, at the times that they are of.

    What is not estimated is NaN: with a lag the last epochs.
    """
    blocks = [
        _track_block(config, walks, slice(begin, begin + BLOCK), np.random.default_rng([seed, begin]), nodes_too)
        for begin in range(0, len(walks.z), BLOCK)
    ]
    return Tracks(*(np.concatenate(column) for column in zip(*blocks, strict=True)))


def _track_block(
    config: HumanConfig, walks: Walks, block: slice, generator: np.random.Generator, nodes_too: bool
) -> Tracks:
    walks = walks._replace(states=walks.states[block], z=walks.z[block])
    runs = walks.z.shape[:1]
    human = HumanFilter(config.checked(), walks.anchors, walks.area)
    sigma = np.hypot(config.signal.sigma or walks.anchors.sigma_db, config.extra_db)
    curves = curves_of(config, walks.anchors)
    past = Ancestry(config.lag)
    state = human.begin(runs, generator)
    mean, covariance = np.full_like(walks.states, np.nan), np.full((*walks.states.shape, 4), np.nan)
    reset, by_node = np.zeros(walks.z.shape[:2], dtype=np.bool_), np.full(walks.z.shape, np.nan)
    for k, t in enumerate(walks.times.tolist()):
        dt = t - float(walks.times[k - 1]) if k else 0.0
        z = walks.z[:, k]
        readings = Readings(z, np.broadcast_to(sigma, z.shape), curves)
        step = human.step(state, dt, readings, generator)
        state, reset[:, k] = step.track, step.reset
        if nodes_too:
            by_node[:, k] = human.evidence_by_node(step)
        if not config.lag:
            mean[:, k], covariance[:, k] = step.mean, step.covariance
            continue
        past.add(t, step.cloud.s[..., PLANAR, :], step.covariance, step.parents)
        if past.before(t - config.lag):
            then = int(np.argmin(np.abs(walks.times - (t - config.lag))))
            mean[:, then], covariance[:, then] = past.moments(t - config.lag, step.cloud.w)
    return Tracks(mean, covariance, reset, by_node)


def distances(tracks: Tracks, walks: Walks) -> Floats:
    """Error of the position (runs, K) [m]."""
    return np.asarray(np.hypot(*np.moveaxis(tracks.mean - walks.states, -1, 0)[:2]))


def squares(tracks: Tracks, walks: Walks, settled: float = SETTLED) -> Floats:
    """Mean squared error of the position of every run (runs,) [m^2], from `settled` seconds on."""
    return np.asarray(np.nanmean(distances(tracks, walks)[:, walks.times >= settled] ** 2, axis=-1))

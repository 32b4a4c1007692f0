"""System D over many runs at once: the steps that the tracker takes, with a leading axis of runs."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wsn_tracking.filters import recent
from wsn_tracking.filters.ekf import Gaussian
from wsn_tracking.filters.least_squares import least_squares
from wsn_tracking.models.anchors import Floats, Mask
from wsn_tracking.models.measurement import distances
from wsn_tracking.models.radio import MIN_RANGE
from wsn_tracking.simulation.d_cells import CellsConfig, Measured, measure, nodes
from wsn_tracking.trackers import hybrid_literal as literal
from wsn_tracking.trackers import hybrid_steps as steps
from wsn_tracking.trackers.hybrid_config import HybridConfig
from wsn_tracking.trackers.hybrid_listening import listen, reading_of


class Runs(NamedTuple):
    """The same walk, measured many times."""

    config: CellsConfig
    states: Floats  # (K, 4)
    told: Measured  # (runs, K)


class Tracks(NamedTuple):
    """What a filter made of every run."""

    m: Floats  # (runs, K, 4); NaN before the start
    P: Floats  # (runs, K, 4, 4)
    manoeuvres: Mask  # (runs, K)


def sample(config: CellsConfig, states: Floats, runs: int, seed: int) -> Runs:
    """Runs over states (K, 4), each with its own noise and losses, and a station that chooses its cells."""
    generator = np.random.default_rng(seed)
    shape = (runs, len(states))
    many = np.broadcast_to(states, (*shape, 4))
    normals, uniforms = generator.standard_normal(shape), generator.random(shape)
    return Runs(config, states, measure(config, many, normals, uniforms))


def listened(runs: Runs, config: HybridConfig) -> tuple[Floats, Floats]:
    """Least squares of the latest ranges, raw (runs, K, 2) and low-passed (runs, K, 4); NaN where there is none."""
    places = nodes().positions
    shape = runs.told.z.shape
    told = recent.nothing(shape[:1], len(places))
    raw, smooth = np.empty((*shape, 2)), np.empty((*shape, 4))
    for k in range(shape[1]):
        reading = reading_of(runs.told.z[:, k], runs.told.rows[:, k], config.range_std)
        told = listen(told, reading, k * runs.config.period, places, config)
        raw[:, k], smooth[:, k] = told.raw, told.x
    return raw, smooth


def track(runs: Runs, config: HybridConfig) -> Tracks:
    """Filter every run; each begins where least squares first finds its target, with P0 = diag(start.*_std^2)."""
    places = nodes().positions
    raw, _ = listened(runs, config)
    P0 = np.broadcast_to(config.start.P0, (len(raw), 4, 4))
    found = np.zeros(len(raw), dtype=np.bool_)
    state = steps.begin(Gaussian(np.zeros((len(raw), 4)), P0), len(places), config)
    m, P = np.full((*raw.shape[:2], 4), np.nan), np.full((*raw.shape[:2], 4, 4), np.nan)
    turned = np.zeros(raw.shape[:2], dtype=np.bool_)
    for k in range(raw.shape[1]):
        begins = ~found & ~np.isnan(raw[:, k, 0])
        state = steps.predict(state, runs.config.period, config)
        z = np.where(found, runs.told.z[:, k], np.nan)
        reading = reading_of(z, runs.told.rows[:, k], config.range_std)
        state, outcome = steps.hear(state, reading, k * runs.config.period, places, config)
        if begins.any():
            first = np.concatenate([np.nan_to_num(raw[:, k]), np.zeros((len(raw), 2))], axis=-1)
            state = steps.restarted(state, begins, Gaussian(first, P0), config)
            found = found | begins
        belief = state.belief
        m[:, k], P[:, k] = np.where(found[:, None], belief.m, np.nan), belief.P
        turned[:, k] = outcome.manoeuvre
    return Tracks(m, P, turned)


def track_together(runs: Runs, config: HybridConfig, seed: int) -> Floats:
    """Means (runs, K, 4) of form literal, which has the ranges of all nodes at once in every period (drawn anew)."""
    places = nodes().positions
    N, many = len(places), len(runs.told.z)
    noise = np.random.default_rng(seed).standard_normal((many, len(runs.states), N))
    z = np.maximum(distances(nodes(), runs.states) + runs.config.range_std * noise, MIN_RANGE)
    std, share = np.full(N, config.range_std), np.zeros(N)
    first = np.concatenate([least_squares(places[:, :2], z[:, 0]), np.zeros((many, 2))], axis=-1)
    state = literal.begin(Gaussian(first, np.broadcast_to(config.start.P0, (many, 4, 4))), N)
    m = np.empty((many, len(runs.states), 4))
    for k in range(len(runs.states)):
        state = literal.predict(state, runs.config.period if k else 0.0, config)
        state, _ = literal.hear(state, z[:, k], std, share, k * runs.config.period, places, config)
        m[:, k] = state.belief.m
    return m

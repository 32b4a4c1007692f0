"""Seed 001: what least squares, Kalman filter, hybrid and two models make of the same ranges."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from wsn_tracking.evaluation.metrics import nees
from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.motion import constant_velocity
from wsn_tracking.reproduction.bounds import path_bound, scalar_information
from wsn_tracking.reproduction.claims import PICTURE, Samples
from wsn_tracking.simulation.d_cells import nodes
from wsn_tracking.studies.hybrid_runs import Runs, listened, track
from wsn_tracking.trackers.hybrid_config import HybridConfig, MotionConfig

LS, EKF, HYBRID, IMM = 'least squares', 'EKF', 'hybrid', 'two models'


def filters(q: float) -> dict[str, HybridConfig]:
    """The filters that are compared."""
    base = HybridConfig(motion=MotionConfig(spectral_density=q))
    return {EKF: replace(base, form='ekf'), HYBRID: base, IMM: replace(base, form='imm')}


def errors(m: Floats, states: Floats) -> Floats:
    """Squared error of the position, (runs, K) [m^2]."""
    return np.asarray(np.sum((m[..., :2] - states[..., :2]) ** 2, axis=-1))


def followed(runs: Runs, q: float) -> Samples:
    """Squared errors (runs, K) [m^2] and NEES (of 2) of every filter, those of one that knows all, one run's tracks."""
    m = {LS: listened(runs, HybridConfig())[0]}
    samples: dict[str, Floats] = {f'{PICTURE}truth': runs.states[:, :2], 'bound': least(runs)}
    for name, config in filters(q).items():
        tracks = track(runs, config)
        m[name] = tracks.m
        e = (tracks.m - runs.states)[:, :, :2]
        samples[f'{name}: nees'] = np.nan_to_num(nees(e, tracks.P[..., :2, :2]))
    for name, states in m.items():
        samples[name] = np.nan_to_num(errors(states, runs.states), nan=0.0)
        samples[f'{PICTURE}{name}'] = states[0, :, :2]
    return samples


def least(runs: Runs) -> Floats:
    """Mean squared error (runs, K) [m^2] of a filter that is linearised at the truth and knows when a robot turns.

    It knows how it goes on as well, but for the one velocity after a change, that may be anything.
    """
    states, T = runs.states, runs.config.period
    heard = ~np.isnan(runs.told.z)
    weights = heard[..., None] * (runs.told.rows[..., None] == np.arange(len(nodes().ids))) / runs.config.range_std**2
    changes = np.any(np.abs(np.diff(states[:, 2:], axis=0)) > 1e-9, axis=-1)
    Q = np.zeros((len(states), 4, 4))
    Q[:-1][changes] = np.diag([0.0, 0.0, 1.0, 1.0])
    information = scalar_information(nodes().positions, states[None, :], weights)
    P = path_bound(np.eye(4), constant_velocity(T), Q, information)
    return np.asarray(np.trace(P[..., :2, :2], axis1=-2, axis2=-1))

"""What each part of system C's filters is worth: resampling, body, outliers, new starts, the disc."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from wsn_tracking.filters.particle import equal, moments, reweighed
from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.body import SINGLE, mean_rssi
from wsn_tracking.models.body_likelihood import Readings
from wsn_tracking.models.walk import STATES
from wsn_tracking.simulation.c_body import BodyConfig, CircleConfig, nodes
from wsn_tracking.studies.human import IMPROVED, PAPER_MAX, SEED, compare, told
from wsn_tracking.studies.human_runs import Walks, distances, sample, track
from wsn_tracking.studies.intervals import mean_of
from wsn_tracking.studies.results import Result
from wsn_tracking.trackers.human_config import HumanConfig, MotionConfig, ResamplingConfig, SignalConfig, StartConfig
from wsn_tracking.trackers.human_filter import HumanFilter
from wsn_tracking.trackers.human_models import curves_of

EXCESSES = (2.3, 2.92)  # of a reset, beside the configured one
FOUND = 5.0  # [m] a target that has jumped is found again when it is nearer than this


def parts(runs: int = 60) -> Result:
    """Resampling as printed, a turned body, outliers."""
    walks = sample(BodyConfig(), runs, SEED)
    inverted = replace(PAPER_MAX, resampling=ResamplingConfig(inverted=True))
    found = compare(walks, {'paper_max': PAPER_MAX, 'inverted': inverted})
    result: Result = {'runs': runs, 'seed': SEED, 'resampling': told(found, ('inverted', 'paper_max'))}
    turned = sample(BodyConfig(yaw=math.radians(30.0)), runs, SEED)
    stiff = replace(IMPROVED, motion=MotionConfig(yaw=0.0))
    found = compare(turned, {'paper_max': PAPER_MAX, 'improved': IMPROVED, 'without_yaw': stiff})
    result['body_turned_30_deg'] = told(found, ('improved', 'paper_max'), ('improved', 'without_yaw'))
    wild = sample(BodyConfig(outliers=0.1), runs, SEED)
    trusting = replace(IMPROVED, signal=SignalConfig(outlier=0.0))
    found = compare(wild, {'improved': IMPROVED, 'without_mass': trusting, 'paper_max': PAPER_MAX})
    result['outliers_10_percent'] = told(found, ('improved', 'without_mass'))
    return result


def teleport(runs: int = 60, at: float = 60.0) -> Result:
    """How soon a target that has jumped is found again."""
    walks = sample(BodyConfig(teleport_at=at, duration=at + 90.0), runs, SEED)
    configs = {
        'reset': IMPROVED,
        **{f'reset_beyond_{x:g}': replace(IMPROVED, start=StartConfig(reset_excess=x)) for x in EXCESSES},
        'no_reset': replace(IMPROVED, start=StartConfig(reset_epochs=0)),
    }
    result: Result = {'runs': runs, 'seed': SEED, 'found_within_m': FOUND}
    for name, config in configs.items():
        times = recovery(distances(track(config, walks, SEED), walks), walks.times, at)
        result[name] = {'median_s': float(np.median(times)), 'slowest_tenth_s': float(np.quantile(times, 0.9))}
    result['median_of_no_reset'] = result['reset']['median_s'] / result['no_reset']['median_s']
    return result


def recovery(d: Floats, times: Floats, at: float) -> Floats:
    """Time (runs,) [s] after `at` until an error (runs, K) is below FOUND; to the end of the run where it never is."""
    after = times >= at
    found = d[:, after] < FOUND
    first = np.where(found.any(axis=-1), np.argmax(found, axis=-1), after.sum() - 1)
    return np.asarray(times[after][first] - at)


def needless(runs: int = 60) -> Result:
    """How often an hour two epochs in a row would have particles drawn anew that follow their target.

    By the excess of the median or of the mean over nodes.
    """
    never = replace(IMPROVED, start=StartConfig(reset_epochs=0))
    middles: Mapping[str, Callable[..., Floats]] = {'median': np.nanmedian, 'mean': np.nanmean}
    worlds = {
        'no_outliers': BodyConfig(),
        'outliers_10_percent': BodyConfig(outliers=0.1),
        'four_nodes': CircleConfig(),
    }
    result: Result = {'runs': runs, 'seed': SEED, 'configured_excess': never.start.reset_excess}
    for name, config in worlds.items():
        walks = sample(config, runs, SEED)
        tracks = track(never, walks, SEED, nodes_too=True)
        surprise = np.where(np.isnan(walks.z), np.nan, -tracks.by_node - np.log(config.sigma))
        follows = distances(tracks, walks) < FOUND
        counts = follows & (np.sum(~np.isnan(surprise), axis=-1) >= never.start.reset_nodes)
        hours = float(follows.sum()) * config.period / 3600.0
        result[name] = {
            f'{kind}_beyond_{excess:g}': per_hour(counts & (of(surprise, axis=-1) > excess), hours)
            for kind, of in middles.items()
            for excess in (never.start.reset_excess, *EXCESSES)
        }
    return result


def per_hour(struck: Any, hours: float) -> float:
    """Pairs of epochs in a row that strike, an hour; one epoch is in one pair."""
    return float((struck[:, 1:] & struck[:, :-1]).sum()) / hours


def silence(runs: int = 60) -> Result:
    """Thirty seconds without any reading, and three seconds after."""
    walks = sample(BodyConfig(silent_from=60.0, silent_until=90.0, duration=100.0), runs, SEED)
    tracks = track(IMPROVED, walks, SEED)
    d = distances(tracks, walks)
    at = np.searchsorted(walks.times, [89.5, 90.0, 93.0])
    return {
        'runs': runs,
        'seed': SEED,
        'finite': bool(np.isfinite(tracks.mean).all() and np.isfinite(tracks.covariance).all()),
        **{f'error_m_{name}': mean_of(d[:, k]) for name, k in zip(('before', 'first', '3_s_later'), at, strict=True)},
        'worst_m_3_s_later': float(d[:, at[2]].max()),
    }


# ---- the lag of a disc


def disc_lag(runs: int = 60, speeds: tuple[float, ...] = (0.5, 1.0, 1.5), v_max: float = 4.0) -> Result:
    """How far a disc lags behind a target that walks straight on, against 2 s1 v / v_max."""
    result: Result = {'runs': runs, 'seed': SEED, 'v_max': v_max}
    for speed in speeds:
        walks, s1 = straight(speed, runs)
        config = HumanConfig(
            profile='paper_max', signal=SignalConfig(kind='single'), motion=MotionConfig(v_max=v_max), particles=1000
        )
        behind = (walks.states[..., 0] - track(config, walks, SEED).mean[..., 0])[:, walks.times >= 15.0]
        lag = behind.mean(axis=-1)
        law = 2.0 * s1 * speed / v_max
        result[f'{speed:g}_m_s'] = {
            'lag_m': mean_of(lag),
            'law_m': law,
            'lag_of_law': mean_of(lag, 1.0 / law),
            's1_m': s1,
        }
    return result


def straight(speed: float, runs: int) -> tuple[Walks, float]:
    """Walks along x, through the middle of c_walk with one curve; s1 [m]: what a single epoch leaves of x."""
    config = BodyConfig(reach=1e6, sigma=3.0)
    anchors, t = nodes(config), config.times[: int(40.0 / speed / config.period)]
    states = np.zeros((runs, t.size, 4))
    states[..., 0], states[..., 1], states[..., 2] = 30.0 + speed * t, 50.0, speed
    d = np.hypot(*np.moveaxis(states[..., None, :2] - anchors.positions[:, :2], -1, 0))
    z = mean_rssi(SINGLE, d) + config.sigma * np.random.default_rng(SEED).standard_normal(d.shape)
    walks = Walks(anchors, config.area, t, states, z)
    human = HumanFilter(HumanConfig(signal=SignalConfig(kind='single', outlier=0.0)), anchors, config.area)
    generator = np.random.default_rng(SEED)
    variances = []
    for k in range(0, t.size, 10):
        draws = equal(human.begin((runs,), generator).cloud.s[..., :2, :].repeat(8, axis=-1))
        places = np.zeros((runs, STATES, draws.s.shape[-1]))
        places[:, :2] = draws.s + 2.0 * generator.standard_normal(draws.s.shape)
        readings = Readings(z[:, k], np.full(z[:, k].shape, config.sigma), curves_of(human.config, anchors))
        after, _ = reweighed(equal(places), human.score(places, readings).l)
        variances.append(moments(places[:, :2], after.w)[1][:, 0, 0])
    return walks, float(np.mean(1.0 / np.array(variances)) ** -0.5)  # what counts is the mean information

"""What the filters of system C reach on the scenarios of seed 003, and what each of their parts is worth."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from wsn_tracking.evaluation.human_runs import Walks, distances, sample, squares, track
from wsn_tracking.evaluation.intervals import Figure, mean_of, ratio_of
from wsn_tracking.filters.particle import equal, moments, reweighed
from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.body import SINGLE, mean_rssi
from wsn_tracking.models.body_likelihood import Readings
from wsn_tracking.models.walk import STATES
from wsn_tracking.simulation.c_body import BodyConfig, CircleConfig, CorridorConfig, SpacingConfig, nodes
from wsn_tracking.trackers.human_config import (
    ChannelConfig,
    HumanConfig,
    MotionConfig,
    ResamplingConfig,
    StartConfig,
    curves_of,
)
from wsn_tracking.trackers.human_filter import HumanFilter

Result = dict[str, Any]
SEED = 1
SPACINGS = {3: 50.0, 4: 33.3, 5: 25.0, 6: 20.0, 8: 14.3, 11: 10.0}  # columns of nodes: metres between them
NOISES = (0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0)  # [dB]
IMPROVED = HumanConfig()
PAPER_MAX = HumanConfig(profile='paper_max')
FOUND = 5.0  # [m] a target that has jumped is found again when it is nearer than this


def baseline(v_max: float, *, widened: bool = True, **more: Any) -> HumanConfig:
    """rss_mcl; not widened: with the deviation s of the readings alone."""
    channel = ChannelConfig() if widened else ChannelConfig(extra=0.0)
    return HumanConfig(profile='rss_mcl', motion=MotionConfig(v_max=v_max), channel=channel, **more)


def direction(v_max: float, **more: Any) -> HumanConfig:
    """paper_direction."""
    return HumanConfig(profile='paper_direction', motion=MotionConfig(v_max=v_max), **more)


def compare(walks: Walks, configs: Mapping[str, HumanConfig]) -> dict[str, Floats]:
    """Mean squared errors (runs,) [m^2] by name."""
    return {name: squares(track(config, walks, SEED), walks) for name, config in configs.items()}


def told(by_name: Mapping[str, Floats], *ratios: tuple[str, str]) -> Result:
    """RMSE of each, and ratios of some, with their intervals."""
    result: Result = {f'rmse_m_{name}': root_of(values) for name, values in by_name.items()}
    for above, below in ratios:
        result[f'{above}_of_{below}'] = ratio_of(by_name[above], by_name[below], root=True)
    return result


def root_of(values: Floats) -> Figure:
    """Root of the mean of squares (runs,)."""
    return ratio_of(values, np.ones_like(values), root=True)


# ---- the document's experiments


def profiles(runs: int = 100) -> Result:
    """Profiles on c_walk, and three seconds later."""
    walks = sample(BodyConfig(), runs, SEED)
    configs = {
        'rss_mcl': baseline(3.0),
        'paper_max': PAPER_MAX,
        'improved': IMPROVED,
        'lagged': replace(IMPROVED, lag=3.0),
    }
    found = compare(walks, configs)
    ratios = (('paper_max', 'rss_mcl'), ('improved', 'paper_max'), ('improved', 'rss_mcl'), ('lagged', 'improved'))
    return {'runs': runs, 'seed': SEED, **told(found, *ratios)}


def circle(runs: int = 100) -> Result:
    """The direction filter against one curve on c_circle."""
    walks = sample(CircleConfig(), runs, SEED)
    configs = {
        'rss_mcl': baseline(2.0),
        'paper_direction': direction(1.65),
        'paper_max': PAPER_MAX,
        'improved': IMPROVED,
    }
    return {'runs': runs, 'seed': SEED, **told(compare(walks, configs), ('paper_direction', 'rss_mcl'))}


def corridor(runs: int = 100) -> Result:
    """The direction filter against one curve on c_corridor, with 50 and 200 particles."""
    walks = sample(CorridorConfig(), runs, SEED)
    result: Result = {'runs': runs, 'seed': SEED}
    for particles in (50, 200):
        configs = {
            'rss_mcl': baseline(0.5, widened=False, particles=particles),
            'paper_direction': direction(0.5, particles=particles),
        }
        result[f'particles_{particles}'] = told(compare(walks, configs), ('paper_direction', 'rss_mcl'))
    return result


def spacing(runs: int = 60, columns: tuple[int, ...] = tuple(SPACINGS)) -> Result:
    """Denser nodes, one epoch a second."""
    result: Result = {'runs': runs, 'seed': SEED}
    before: Floats | None = None
    for number in columns:
        walks = sample(SpacingConfig(columns=number, rows=number), runs, SEED)
        paper = HumanConfig(profile='paper_max', particles=400, motion=MotionConfig(v_max=3.0))
        configs = {'rss_mcl': baseline(3.0, particles=400), 'paper_max': paper}
        found = compare(walks, configs)
        row = told(found, ('paper_max', 'rss_mcl'))
        if before is not None:
            row['paper_max_of_the_wider'] = ratio_of(found['paper_max'], before, root=True)
        before = found['paper_max']
        result[f'{SPACINGS[number]:g}_m'] = row
    return result


def noise(runs: int = 60, levels: tuple[float, ...] = NOISES) -> Result:
    """More noise."""
    result: Result = {'runs': runs, 'seed': SEED}
    before: Floats | None = None
    ones = []
    for sigma in levels:
        walks = sample(BodyConfig(sigma=sigma), runs, SEED)
        found = compare(walks, {'rss_mcl': baseline(3.0), 'paper_max': PAPER_MAX})
        row = told(found, ('paper_max', 'rss_mcl'))
        if before is not None:
            row['paper_max_of_the_quieter'] = ratio_of(found['paper_max'], before, root=True)
        before = found['paper_max']
        ones.append(float(np.sqrt(found['rss_mcl'].mean())))
        result[f'{sigma:g}_dB'] = row
    result['rss_mcl_most_of_least'] = max(ones) / min(ones)
    return result


# ---- what the parts are worth


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
    trusting = replace(IMPROVED, channel=ChannelConfig(outlier=0.0))
    found = compare(wild, {'improved': IMPROVED, 'without_mass': trusting, 'paper_max': PAPER_MAX})
    result['outliers_10_percent'] = told(found, ('improved', 'without_mass'))
    return result


def teleport(runs: int = 60, at: float = 60.0) -> Result:
    """How soon a target that has jumped is found again; how often particles are drawn anew without need."""
    walks = sample(BodyConfig(teleport_at=at, duration=at + 90.0), runs, SEED)
    never = replace(IMPROVED, start=StartConfig(reset_epochs=0))
    result: Result = {'runs': runs, 'seed': SEED, 'found_within_m': FOUND}
    for name, config in {'reset': IMPROVED, 'no_reset': never}.items():
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
    """How often two epochs in a row would have particles drawn anew that follow their target, a median or a mean."""
    never = replace(IMPROVED, start=StartConfig(reset_epochs=0))
    middles: Mapping[str, Callable[..., Floats]] = {'median': np.nanmedian, 'mean': np.nanmean}
    result: Result = {'runs': runs, 'seed': SEED}
    for name, config in {'no_outliers': BodyConfig(), 'outliers_10_percent': BodyConfig(outliers=0.1)}.items():
        walks = sample(config, runs, SEED)
        tracks = track(never, walks, SEED, nodes_too=True)
        surprise = np.where(np.isnan(walks.z), np.nan, -tracks.by_node - np.log(config.sigma))
        follows = distances(tracks, walks) < FOUND
        enough = np.sum(~np.isnan(surprise), axis=-1) >= never.start.reset_nodes
        hours = float(follows.sum()) * config.period / 3600.0
        result[name] = {
            kind: per_hour(enough & follows & (of(surprise, axis=-1) > never.start.reset_excess), hours)
            for kind, of in middles.items()
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
            profile='paper_max', channel=ChannelConfig(kind='single'), motion=MotionConfig(v_max=v_max), particles=1000
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
    human = HumanFilter(HumanConfig(channel=ChannelConfig(kind='single', outlier=0.0)), anchors, config.area)
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

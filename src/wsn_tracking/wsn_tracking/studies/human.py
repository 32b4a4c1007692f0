"""What the filters of system C reach on the scenarios of seed 003, and what each of their parts is worth."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from wsn_tracking.models.anchors import Floats
from wsn_tracking.simulation.c_body import BodyConfig, CircleConfig, CorridorConfig, SpacingConfig
from wsn_tracking.studies.human_runs import Walks, sample, squares, track
from wsn_tracking.studies.intervals import Figure, ratio_of
from wsn_tracking.studies.results import Result
from wsn_tracking.trackers.human_config import HumanConfig, MotionConfig, SignalConfig

SEED = 1
SPACINGS = {3: 50.0, 4: 33.3, 5: 25.0, 6: 20.0, 8: 14.3, 11: 10.0}  # columns of nodes: metres between them
NOISES = (0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0)  # [dB]
IMPROVED = HumanConfig()
PAPER_MAX = HumanConfig(profile='paper_max')


def baseline(v_max: float, *, widened: bool = True, **more: Any) -> HumanConfig:
    """rss_mcl; not widened: with the deviation s of the readings alone."""
    signal = SignalConfig() if widened else SignalConfig(extra=0.0)
    return HumanConfig(profile='rss_mcl', motion=MotionConfig(v_max=v_max), signal=signal, **more)


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
        found = compare(walks, configs)
        result[f'particles_{particles}'] = {
            **told(found, ('paper_direction', 'rss_mcl')),
            'median_walk': float(np.sqrt(np.median(found['paper_direction'] / found['rss_mcl']))),
        }
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

"""Beyond seed 002: other ways to agree, what they send, and how far they are from the best."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.motion import constant_velocity
from wsn_tracking.models.noise import white_acceleration
from wsn_tracking.reproduction.b_field import CM, settled
from wsn_tracking.reproduction.bounds import path_bound, range_bearing_information
from wsn_tracking.reproduction.claims import BEYOND, Claim, Experiment, Figure, Plot, Samples
from wsn_tracking.reproduction.quantities import bars, mean, ratio, root_mean
from wsn_tracking.simulation.b_field import FieldConfig
from wsn_tracking.studies import consensus_runs as runs_of
from wsn_tracking.studies.consensus_runs import SETTLED, Worlds
from wsn_tracking.studies.consensus_schemes import guards
from wsn_tracking.trackers.consensus_config import ConsensusConfig

OURS = ConsensusConfig()
SCHEMES = {
    'cm, 20 rounds': CM,
    'icf, 20 rounds': replace(OURS, scheme='icf'),
    'flood, 5 rounds': replace(OURS, scheme='flood', rounds=5),
    'hcmci, 20 rounds': replace(OURS, scheme='hcmci'),
    'centralised': replace(OURS, scheme='flood', rounds=49),
}
ACCELERATED = 'chebyshev'


def schemes(seed: int, runs: int) -> Samples:
    """Every scheme over the same fields: squared errors, NEES, and what a node sends in an epoch."""
    worlds = runs_of.sample(FieldConfig(), runs, seed)
    samples: dict[str, Floats] = {}
    for name, config in SCHEMES.items():
        samples |= measured(name, config, worlds)
    parts: list[dict[str, Floats]] = []
    guard = guards(worlds)
    for run in range(runs):  # each with the fewest rounds that pay in its own field
        config = replace(OURS, scheme='chebyshev', rounds=int(guard[run]))
        parts.append(measured(ACCELERATED, config, runs_of.some(worlds, slice(run, run + 1))))
    samples |= {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    return {**samples, 'bound': least(worlds)}


def least(worlds: Worlds) -> Floats:
    """Mean squared position error (runs,) [m^2] of a filter linearised at the truth and told what arrived."""
    config = FieldConfig()
    root = white_acceleration(config.spectral_density, 1.0)
    arrived = worlds.arrived.astype(np.float64)
    information = range_bearing_information(worlds.positions[:, None], worlds.states, arrived, worlds.R)
    P = path_bound(np.diag(np.square(config.std)), constant_velocity(1.0), root @ root.T, information)
    return np.asarray(np.trace(P[:, SETTLED:, :2, :2], axis1=-2, axis2=-1).mean(axis=-1))


def measured(name: str, config: ConsensusConfig, worlds: Worlds) -> dict[str, Floats]:
    """One scheme."""
    scores = runs_of.track(config, worlds)
    sent = [runs_of.traffic(config, positions) for positions in worlds.positions]
    return {
        f'{name}: squares': settled(scores.squares),
        f'{name}: nees': settled(scores.nees),
        f'{name}: messages': np.array([float(t.messages) for t in sent]),
        f'{name}: bytes': np.array([t.bytes_nominal for t in sent]),
    }


AGREEING = Experiment('b schemes', schemes, runs=10, units=16, quick=6)


def flood(s: Samples) -> Sequence[Figure]:
    """Forwarding by name against averaging."""
    ours, cm = 'flood, 5 rounds', 'cm, 20 rounds'
    return [
        ratio('RMSE, flood / cm', s[f'{ours}: squares'], s[f'{cm}: squares'], True, shape=(None, 1.0)),
        ratio('bytes, flood / cm', s[f'{ours}: bytes'], s[f'{cm}: bytes'], shape=(None, 0.5)),
        ratio('messages, flood / cm', s[f'{ours}: messages'], s[f'{cm}: messages'], shape=(None, 0.3)),
        mean('NEES (of 4), flood', s[f'{ours}: nees'], shape=(3.5, 4.6)),
        mean('NEES (of 4), cm', s[f'{cm}: nees']),
        root_mean('RMSE, flood', s[f'{ours}: squares'], 'm'),
        root_mean('RMSE, cm', s[f'{cm}: squares'], 'm'),
    ]


def others(s: Samples) -> Sequence[Figure]:
    """icf, chebyshev and hcmci against cm."""
    cm = s['cm, 20 rounds: squares']
    return [
        ratio('RMSE, icf / cm', s['icf, 20 rounds: squares'], cm, True, shape=(0.95, 1.01)),
        ratio('RMSE, chebyshev / cm', s[f'{ACCELERATED}: squares'], cm, True, shape=(None, 1.0)),
        ratio('bytes, chebyshev / cm', s[f'{ACCELERATED}: bytes'], s['cm, 20 rounds: bytes'], shape=(None, 0.9)),
        mean('NEES (of 4), icf', s['icf, 20 rounds: nees']),
        mean('NEES (of 4), chebyshev', s[f'{ACCELERATED}: nees']),
        mean('NEES (of 4), hcmci', s['hcmci, 20 rounds: nees'], shape=(None, 3.0)),
        ratio('RMSE, hcmci / cm', s['hcmci, 20 rounds: squares'], cm, True),
    ]


def schemes_plot(s: Samples) -> Sequence[Plot]:
    """RMSE of all, and what they send."""
    names = [*SCHEMES, ACCELERATED]
    errors = [(name.split(',')[0], root_mean(name, s[f'{name}: squares'])) for name in names]
    sent = [(name.split(',')[0], mean(name, s[f'{name}: bytes'])) for name in names]
    return [
        Plot('Accuracy', 'scheme', 'RMSE [m]', [bars('ours', errors)]),
        Plot('What a node sends', 'scheme', 'bytes an epoch', [bars('ours', sent)]),
    ]


def bound(s: Samples) -> Sequence[Figure]:
    """The centralised filter against the bound of one that knows which observations arrived."""
    return [
        ratio(f'RMSE / bound, {name}', s[f'{name}: squares'], s['bound'], True, shape=limits)
        for name, limits in (('centralised', (0.9, 1.15)), ('flood, 5 rounds', None), ('cm, 20 rounds', None))
    ]


CLAIMS = (
    Claim(
        'B21',
        'B',
        'schemes',
        "Forwarding every node's contribution by name, five rounds, is more accurate than the document's twenty "
        'rounds of averaging, with less than half of its bytes and a quarter of its messages, and it is honest.',
        AGREEING,
        flood,
        schemes_plot,
        'Bytes by a nominal model: a share 64, a forwarded item 10, 8 a broadcast. Averages that have not settled '
        'count some nodes twice and others not at all: overconfident.',
        kind=BEYOND,
    ),
    Claim(
        'B22',
        'B',
        'schemes',
        "Averaging prior and contribution together (icf) is as accurate as the document's at the same cost and bears "
        'different starts; acceleration (chebyshev) is better at fewer rounds; hcmci is never overconfident.',
        AGREEING,
        others,
        kind=BEYOND,
    ),
    Claim(
        'B25',
        'B',
        'Cramer-Rao bound',
        'The centralised filter comes within 15 % of the Cramer-Rao recursion along each true path: a filter that is '
        'linearised at the truth and told which observations arrived.',
        AGREEING,
        bound,
        kind=BEYOND,
    ),
)

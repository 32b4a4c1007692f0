"""Beyond seed 002: shares that are lost, a node that dies, observations that read what nobody expects."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.graph import adjacency, is_connected
from wsn_tracking.reproduction.b_field import CM, settled
from wsn_tracking.reproduction.b_schemes import OURS
from wsn_tracking.reproduction.claims import BEYOND, Claim, Experiment, Figure, Samples
from wsn_tracking.reproduction.quantities import ratio, root_mean
from wsn_tracking.simulation.b_field import FieldConfig
from wsn_tracking.studies import consensus_runs as runs_of
from wsn_tracking.trackers.consensus_config import ArrivalConfig, LinkConfig


def faults(seed: int, runs: int) -> Samples:
    """Losses of links, a death, and faults that the filter does not expect."""
    worlds = runs_of.sample(FieldConfig(), runs, seed)
    samples: dict[str, Floats] = {}
    for scheme, rounds in (('cm', 20), ('flood', 5)):
        base = replace(OURS, scheme=scheme, rounds=rounds)
        for loss in (0.0, 0.3, 0.5):
            config = replace(base, link=LinkConfig(loss=loss, seed=seed % 2**31))
            samples[f'{scheme}, {loss:.0%} lost'] = settled(runs_of.track(config, worlds).squares)
        alive = np.ones(worlds.arrived.shape[1:], dtype=np.bool_)
        alive[25:, 0] = False
        dead, whole = (settled(runs_of.track(base, worlds, a).squares[:, :, 1:]) for a in (alive, None))
        held = is_connected(adjacency(worlds.positions[:, 1:], base.radius))  # its death parts nobody
        samples[f'{scheme}, death'] = np.where(held, dead, whole)
        samples[f'{scheme}, no death'] = whole
    clutter = runs_of.sample(replace(FieldConfig(), faults='clutter'), runs, seed)
    for name, some in (('zero', worlds), ('clutter', clutter)):
        for model in ('zero', 'uniform'):
            config = replace(CM, arrival=ArrivalConfig(loss=model))
            samples[f'{name} faults, {model} model'] = settled(runs_of.track(config, some).squares)
    return samples


FAULTS = Experiment('b faults', faults, runs=10, units=12, quick=4)


def links(s: Samples) -> Sequence[Figure]:
    """RMSE against that without losses."""
    found = []
    for scheme, most, half in (('cm', 1.3, (None, 1.6)), ('flood', 1.5, None)):
        whole = s[f'{scheme}, 0% lost']
        found += [
            ratio(f'{scheme}, 30 % of the shares lost', s[f'{scheme}, 30% lost'], whole, True, shape=(None, most)),
            ratio(f'{scheme}, 50 % of the shares lost', s[f'{scheme}, 50% lost'], whole, True, shape=half),
            ratio(f'{scheme}, node 1 dies', s[f'{scheme}, death'], s[f'{scheme}, no death'], True, shape=(None, 1.1)),
        ]
    return found


def unexpected(s: Samples) -> Sequence[Figure]:
    """The document's model of a lost observation, and one that expects anything."""
    zero, uniform = 'zero model', 'uniform model'
    return [
        ratio(
            'faults that read anything: zero model / uniform model',
            s[f'clutter faults, {zero}'],
            s[f'clutter faults, {uniform}'],
            True,
            shape=(100.0, None),
        ),
        ratio(
            'faults that read zero: uniform model / zero model',
            s[f'zero faults, {uniform}'],
            s[f'zero faults, {zero}'],
            True,
            shape=(None, 1.05),
        ),
        root_mean(
            'RMSE, faults that read anything, uniform model', s[f'clutter faults, {uniform}'], 'm', shape=(None, 1.0)
        ),
    ]


CLAIMS = (
    Claim(
        'B23',
        'B',
        'lost shares, a death',
        'With 30 % of the shares lost, averaging is at most 30 % less accurate, with half of them 60 %; flooding '
        'loses more, having no round to spare; and a node that dies costs next to nothing.',
        FAULTS,
        links,
        kind=BEYOND,
    ),
    Claim(
        'B24',
        'B',
        'other faults',
        "The document's model of a lost observation loses the target when faults read anything but zero; one that "
        'expects anything does not, and costs nothing where they do read zero.',
        FAULTS,
        unexpected,
        kind=BEYOND,
    ),
)

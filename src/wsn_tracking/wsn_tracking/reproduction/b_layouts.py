"""Seed 002, section 3: the radio radius that the document gives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from wsn_tracking.models.graph import adjacency, component_sizes, is_connected
from wsn_tracking.reproduction.claims import Claim, Experiment, Figure, Samples
from wsn_tracking.reproduction.quantities import mean
from wsn_tracking.simulation.b_field import FieldConfig


def layouts(seed: int, runs: int) -> Samples:
    """Random layouts with the document's radius of 50 m: whether they are one network, how large a node's part is."""
    config = replace(FieldConfig(), radius=0.0)
    drawn = np.random.default_rng(seed).random((runs, config.nodes, 2)) * (config.width, config.depth)
    graph = adjacency(drawn, 50.0)
    return {
        'connected': is_connected(graph).astype(np.float64),
        'part': component_sizes(graph).mean(axis=-1).astype(np.float64),
    }


LAYOUTS = Experiment('b layouts', layouts, runs=1000, units=10, quick=2)


def radius(s: Samples) -> Sequence[Figure]:
    """Random layouts at 50 m."""
    return [
        mean('layouts that are one network', s['connected'], '%', 100.0, document='all'),
        mean(
            'nodes that hear each other, in any number of hops', s['part'], 'of 50', document=50.0, shape=(49.0, None)
        ),
    ]


CLAIMS = (
    Claim(
        'B4',
        'B',
        'section 3',
        'Fifty nodes at random on 350 x 400 m with a radio radius of 50 m reach consensus.',
        LAYOUTS,
        radius,
        remark='A radius of 50 m leaves islands; ours is 100 m, and layouts are drawn until they are one network.',
        impossible='No random layout of fifty nodes is one network at 50 m, so no scheme between neighbours can bring '
        "its nodes to agree. The layout of the document's figure 1 is not given.",
    ),
)

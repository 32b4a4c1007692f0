"""Fourteen nodes of system B, what they read for twelve epochs, and two of them alone."""

import numpy as np
from consensus_cases import epoch_of, network_of

from wsn_tracking.simulation.b_field import FieldConfig
from wsn_tracking.studies.consensus_runs import sample
from wsn_tracking.trackers.consensus_config import ConsensusConfig, LinkConfig

SMALL = FieldConfig(nodes=14, width=190.0, depth=210.0, epochs=12)
WORLDS = sample(SMALL, 1, 4)
POSITIONS, Z = WORLDS.positions[0], WORLDS.z[0]
IDS = range(1, 15)
SCHEMES = ['cm', 'icf', 'flood', 'hcmci', 'chebyshev']
FAULTS = {
    'none': LinkConfig(),
    'loss': LinkConfig(loss=0.3, seed=5),
    'cut': LinkConfig(cut_at=95.0, cut_from=3, cut_until=8),
}


def epochs(k, living=IDS):
    """Epoch k for every node that lives."""
    return dict.fromkeys(living, epoch_of(k, Z[k]))


def pair(config=None):
    """Two neighbours."""
    nodes = network_of(config or ConsensusConfig(rounds=2), np.array([[0.0, 0.0, 0.0], [60.0, 0.0, 0.0]]))
    return nodes[1], nodes[2]


def reading(k):
    """Epoch k as two neighbours read it."""
    return epoch_of(k, np.array([[70.0, 0.8], [50.0, 1.7]]))

"""What consensus costs as a network grows."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np

from wsn_tracking.models.graph import adjacency, degrees, diameter
from wsn_tracking.simulation.b_field import FieldConfig, grown
from wsn_tracking.studies import consensus_runs as runs_of
from wsn_tracking.studies.consensus_runs import rmse, traffic
from wsn_tracking.studies.consensus_schemes import Row, Table
from wsn_tracking.trackers.consensus_config import ConsensusConfig

SIZES = (10, 25, 50, 100, 200, 400)  # nodes
EPOCHS = 20


def scaling(field: FieldConfig, node_epochs: int, seed: int) -> Table:
    """From 10 to 400 nodes at the density of the document: what a node-epoch costs and what a node sends."""
    table = []
    for nodes in SIZES:
        runs = max(node_epochs // (nodes * EPOCHS), 1)
        worlds = runs_of.sample(replace(grown(field, nodes), epochs=EPOCHS), runs, seed)
        graph = adjacency(worlds.positions, ConsensusConfig().radius)
        row: Row = {'name': f'{nodes} nodes', 'runs': runs, 'neighbours': float(np.mean(degrees(graph)))}
        row['diameter'] = diameter(graph)
        for name, config in {
            'icf_20': ConsensusConfig(),
            'flood_5': ConsensusConfig(scheme='flood', rounds=5),
        }.items():
            began = time.process_time()
            scores = runs_of.track(config, worlds)
            row[f'us_a_node_epoch_{name}'] = 1e6 * (time.process_time() - began) / scores.nees.size
            row[f'rmse_m_{name}'] = rmse(scores)
            row[f'bytes_nominal_{name}'] = traffic(config, worlds.positions).bytes_nominal
        table.append(row)
    return table

"""hybrid_tracker_node as the base station: ranges up a simulated line, down it who is to measure from now on."""

from __future__ import annotations

from collections import Counter

import numpy as np
from wsn_tracking_msgs import msg

import live
from observer import observing
from wsn_tracking.bags.save import save
from wsn_tracking.graphs import Process
from wsn_tracking.models.measurement import distances
from wsn_tracking.nodes import qos
from wsn_tracking.sensing.values import EpochEnd, Modality, Range, Request
from wsn_tracking.simulation.d_cells import CellsConfig, d_stop
from wsn_tracking.simulation.record import record

TIMEOUT = 60.0
T = 0.1  # [s]
EPOCHS = 50


def everybody():
    """A robot that every node ranges in every epoch, if it is not told to rest."""
    walk = record(d_stop(CellsConfig(period=T)), 1)
    places = walk.truth[1].positions[:EPOCHS]
    draws = np.random.default_rng(1)
    ids = walk.anchors.ids.tolist()
    messages = []
    for k, place in enumerate(places):
        stamp = int(walk.truth[1].stamps_ns[k])
        ranges = distances(walk.anchors, place[:2]) + 0.02 * draws.standard_normal(len(ids))
        sent = [
            Range(stamp, i, 1, k, k, int(Modality.ULTRASOUND), max(d, 0.01), 4e-4)
            for i, d in zip(ids, ranges, strict=True)
        ]
        end = EpochEnd(stamp, 1, k, 'range', tuple(ids), (k,) * len(ids), k == EPOCHS - 1)
        messages += [Request(stamp, 1, k), *sent, end]
    return walk._replace(messages=tuple(messages))


def test_only_the_cell_round_the_prediction_measures_once_the_target_is_found(tmp_path):
    recording = everybody()
    save(tmp_path / 'bag', recording)
    link, anchors = str(tmp_path / 'sink'), recording.anchors
    table = {
        'anchors.ids': anchors.ids.tolist(),
        'anchors.x': anchors.positions[:, 0].tolist(),
        'anchors.y': anchors.positions[:, 1].tolist(),
    }
    sink = {'link': link, 'bag': str(tmp_path / 'bag'), 'publish_anchors': False, 'linger': 60.0}
    seen = {'targets': [1], 'expected_subscribers': ['estimate/hybrid_target_1=1']}  # by the observer, from the start
    heard_by_both = {'expected_subscribers': ['range=2']}
    line = {'port': link, 'period': T, 'sensing_command': True}
    graph = [
        Process('hybrid_tracker_node', 'tracker', {'schedule': True, 'period': T, 'input': 'range', **seen}),
        Process('serial_bridge_node', 'bridge', {**line, **table, **heard_by_both}),
        Process('sink_simulator', 'sink', {**sink, 'expected_nodes': ['tracker', 'bridge']}),
    ]
    with (
        live.private_domain() as environment,
        observing(environment) as observer,
        live.started(graph, environment) as running,
    ):
        ranges = observer.collect(msg.RangeMeasurement, 'range', qos.MEASUREMENTS)
        estimates = observer.collect(msg.TargetEstimate, 'estimate/hybrid_target_1', qos.ESTIMATES)
        observer.until(lambda: len(estimates) >= EPOCHS - 1, TIMEOUT, f'{EPOCHS - 1} estimates')
        assert all(process.poll() is None for process in running.values())
    heard = Counter(m.request_seq for m in ranges)
    assert heard[0] == 12
    last = np.mean([heard[k] for k in range(EPOCHS - 20, EPOCHS)])
    assert 3.0 <= last <= 5.0  # four, and for a moment those of the next cell
    truth = recording.truth[1].positions
    off = [np.hypot(*(np.array(e.mean[:2]) - truth[e.request_seq, :2])) for e in estimates[-20:]]
    assert max(off) < 0.2

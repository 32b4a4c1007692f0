"""The human tracker as a process: what must not break it, and a person whose worn node reports over the serial line."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from nav_msgs.msg import Odometry
from std_msgs.msg import String
from wsn_tracking_msgs import msg

import live
from feeding import Feed
from observer import observing
from radio import LIVE, PATIENCE, QUIET, Radio
from wsn_tracking import graphs
from wsn_tracking.airwaves import air_epochs
from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.nodes import convert, qos
from wsn_tracking.sensing.values import EpochEnd, Request, Rssi
from wsn_tracking.simulation.record import record
from wsn_tracking.simulation.scenarios import scenario
from wsn_tracking.trackers.estimate import check_usable

TIMEOUT = 120.0
SECOND = 1_000_000_000
START = 1_500_000_000 * SECOND
CORNERS = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]]
LIKELY = (-60.0, -62.0, -64.0, -62.0)

# What is heard in an epoch, by node, and how much later than the epoch before it is [s].
EPOCHS = [
    *[(dict(enumerate(LIKELY, 1)), 0.5)] * 3,
    ({}, 0.5),
    ({2: -60.0}, 0.5),
    ({1: 127.0, 2: -128.0, 3: 127.0, 4: -128.0}, 0.5),
    ({1: math.nan, 2: math.inf, 3: -math.inf}, 0.5),
    (dict(enumerate(LIKELY, 1)), 0.0),
    (dict(enumerate(LIKELY, 1)), -0.3),
    ({1: -126.0, 2: -126.0, 3: -126.0, 4: -126.0}, 0.8),
    (dict(enumerate(LIKELY, 1)), 3600.0),
    ({99: -50.0, 1: -55.0}, 0.5),
    (dict(enumerate(LIKELY, 1)), -3600.0),
    (dict(enumerate(LIKELY, 1)), 0.5),
]


@pytest.mark.parametrize('places', [CORNERS, [[3.0, 3.0]] * 4], ids=['corners', 'one_place'])
def test_nothing_that_is_heard_breaks_it(places):
    """Every epoch is answered by finite estimates within the area; the process lives and ends well."""
    anchors = make_anchors([1, 2, 3, 4], places, p1_dbm=-49.0, n=2.4, sigma_db=3.0)
    area = [0.0, 0.0, 10.0, 10.0]
    values = {'input': 'rssi', 'particles': 300, 'lag': 1.0, 'area': area, 'loss_timeout': 0.2}
    graph = [graphs.Process('human_tracker_node', 'human_tracker', values)]
    with (
        live.private_domain() as environment,
        observing(environment) as observer,
        live.started(graph, environment) as running,
    ):
        feed = Feed(observer, anchors, Rssi)
        told = observer.collect(msg.TargetEstimate, 'estimate/human', qos.ESTIMATES)
        lagged = observer.collect(msg.TargetEstimate, 'estimate/human_lag', qos.ESTIMATES)
        poses = observer.collect(Odometry, 'odometry/human', qos.ESTIMATES)
        feed.until_heard(TIMEOUT)
        stamp, sent = START, dict.fromkeys((*anchors.ids.tolist(), 99), 0)
        for k, (heard, later) in enumerate(EPOCHS):
            stamp += round(later * SECOND)
            messages = [Request(stamp, 1, k)]
            for i, dbm in heard.items():
                messages.append(Rssi(stamp, i, 1, sent[i], k, dbm))
                sent[i] += 1
            seqs = tuple(m.seq for m in messages[1:])
            messages.append(EpochEnd(stamp, 1, k, 'rssi', tuple(heard), seqs, final=k == len(EPOCHS) - 1))
            feed.send(*messages)
            if later > -1.0:  # a jump back counts when a second request follows it there
                observer.until(lambda n=k + 1: min(len(told), len(lagged)) >= n, TIMEOUT, f'the estimate of epoch {k}')
            assert running['human_tracker'].poll() is None
        observer.until(lambda: len(poses) >= 1, TIMEOUT, 'odometry')
    assert [e.request_seq for e in told] == list(range(len(EPOCHS)))
    for m in [*told, *lagged]:
        estimate = check_usable(convert.estimate_value(m))
        assert np.all((estimate.mean[:2] >= -1e-9) & (estimate.mean[:2] <= 10.0 + 1e-9))
        assert np.trace(estimate.covariance[:2, :2]) <= 51.0  # half of the area's diagonal, squared
        assert np.trace(estimate.covariance[2:, 2:]) <= 100.0


def test_a_person_whose_worn_node_reports_is_followed(tmp_path):
    """Type 4 frames of c_circle through sink, bridge and tracker, at four times the speed: he walks 1 m/s then."""
    whole = record(scenario('c_circle', {'duration': 10.0, 'slowest': 0.25}, seed=1), 1)
    table = whole.anchors
    field = {
        'anchors.ids': table.ids.tolist(),
        'anchors.x': table.positions[:, 0].tolist(),
        'anchors.y': table.positions[:, 1].tolist(),
        'anchors.p1_dbm': table.p1_dbm.tolist(),
        'anchors.n': table.n.tolist(),
        'anchors.sigma_db': table.sigma_db.tolist(),
    }
    patient = {name: LIVE[name] for name in ('epoch_timeout', 'loss_timeout', 'timeout.settle')}
    settings = {**patient, **field, 'port': str(tmp_path / 'sink'), 'period': 0.5, 'area': [-15.0, -15.0, 15.0, 15.0]}
    graph = graphs.serial('human', trackers='human', settings=settings)
    radio = Radio(tmp_path / 'sink', air_epochs(whole), traffic=dataclasses.replace(QUIET, payload='worn'), rate=4.0)
    with (
        live.private_domain() as environment,
        observing(environment) as observer,
        radio.running(),
        live.started(graph, environment) as running,
    ):
        told = observer.collect(msg.TargetEstimate, 'estimate/human', qos.ESTIMATES)
        ready = observer.collect(String, 'ready', qos.LATCHED)
        observer.until(lambda: {m.data for m in ready} >= {p.name for p in graph}, TIMEOUT, 'all are ready')
        radio.may_begin.set()
        observer.until(lambda: len(told) >= 20, PATIENCE, 'twenty estimates')
        assert running['human_tracker'].poll() is None
    assert {m.target_id for m in told} == {1}
    assert {tuple(m.measurements) for m in told} == {(1, 2, 3, 4)}
    truth = whole.truth[1].positions
    errors = [math.hypot(m.mean[0] - truth[m.request_seq, 0], m.mean[1] - truth[m.request_seq, 1]) for m in told]
    assert math.sqrt(sum(e**2 for e in errors[10:]) / len(errors[10:])) < 4.0  # a circle of 10 m; usual are 1.5 m

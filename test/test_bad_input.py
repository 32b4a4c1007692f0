"""Bad messages of every kind, sent to running nodes: counted, reported, never a wrong estimate."""

from __future__ import annotations

import numpy as np
import pytest
from wsn_tracking_msgs import msg

from feeding import Feed
from live import private_domain, started
from observer import observing
from wsn_tracking.graphs import Process
from wsn_tracking.nodes import convert, qos
from wsn_tracking.sensing.recording import epoch_key
from wsn_tracking.sensing.values import EpochEnd, Request, Rssi
from wsn_tracking.simulation.record import record
from wsn_tracking.simulation.scenarios import scenario
from wsn_tracking.trackers.estimate import Estimate

TIMEOUT = 120.0  # [s] far beyond what a start takes on a busy machine
EPOCHS = 12
NAN = float('nan')


def graph():
    """A sensing process and estimator 1, whose peer 2 is the test."""
    common = {'loss_timeout': 2.0, 'target_id': 1}
    return [
        Process('sensing_node', 'sensing', {**common, 'trigger.kind': 'always'}),
        Process('estimator_node', 'estimator_1', {**common, 'peers': [1, 2], 'input': 'range', 'fusion_timeout': 0.3}),
    ]


def spoilt(message):
    """What comes beside a good message: nothing of it may count."""
    if isinstance(message, Request):
        if message.seq == 5:
            yield Request(0, 1, 5000)  # a clock of 1970
        yield Request(message.stamp_ns, 2, message.seq)  # another target
        yield message  # once more
    elif isinstance(message, Rssi) and message.node_id == 3:
        for i, dbm in enumerate((NAN, 127.0, -128.0, float('inf'), -1e300)):
            yield message._replace(node_id=4, seq=message.seq + 1000 + i, rssi_dbm=dbm)
        yield message._replace(node_id=999)  # no such node
        yield message._replace(target_id=2, rssi_dbm=-30.0)
        yield message._replace(request_seq=0, seq=7777)  # of an epoch long closed
        yield message


def bad_peers(estimate: Estimate):
    """What a neighbour must not be able to do."""
    P = estimate.covariance
    yield estimate._replace(covariance=np.zeros((4, 4)))
    yield estimate._replace(covariance=np.full((4, 4), NAN))
    yield estimate._replace(covariance=np.diag([1.0, 1.0, 1.0, -1.0]))
    yield estimate._replace(covariance=np.outer(P[0], P[0]))
    yield estimate._replace(mean=np.array([NAN, 0.0, 0.0, 0.0]))


WRONG = {  # what is bad, by who counts it and why
    'sensing': {
        'dropped.other_anchors': 1,
        'dropped.unknown_node': EPOCHS,
        'dropped.duplicate, dropped.late': 7 * EPOCHS,  # by which side of the close
        'dropped.other_target': 2 * EPOCHS,
        'dropped.duplicate_request': EPOCHS,
        'dropped.stray_request': 1,
        'used': 12 * EPOCHS,
    },
    'estimator_1': {
        'dropped.other_anchors': 1,
        'malformed.trigger_report': EPOCHS,
        'malformed.estimate/local_2': 6 * EPOCHS,
    },
}


def counted(observer):
    """The counters of `WRONG`, as the nodes tell them."""
    told = {name: observer.told(f'/{name}') for name in WRONG}
    return {
        name: {names: sum(int(told[name].get(each, 0)) for each in names.split(', ')) for names in wanted}
        for name, wanted in WRONG.items()
    }


@pytest.fixture(scope='module')
def outcome():
    """Estimates of a run in which good and bad messages alternate; what is bad is counted by its reason."""
    recording = record(scenario('a_loop'), 1)
    messages = [m for m in recording.messages if epoch_key(m)[1] < EPOCHS]
    with private_domain() as environment, observing(environment) as observer, started(graph(), environment) as running:
        node = observer.node
        feed = Feed(observer, recording.anchors, Rssi)
        peer = node.create_publisher(msg.TargetEstimate, 'estimate/local_2', qos.ESTIMATES)
        reports = node.create_publisher(msg.TriggerReport, 'trigger_report', qos.MEASUREMENTS)
        local = observer.collect(msg.TargetEstimate, 'estimate/local_1', qos.ESTIMATES)
        fused = observer.collect(msg.TargetEstimate, 'estimate/fused_1', qos.ESTIMATES)
        feed.until_heard(TIMEOUT, request=2, epoch_end=2)
        observer.until(lambda: reports.get_subscription_count() == 1, TIMEOUT, 'estimator_node')
        observer.until(lambda: peer.get_subscription_count() == 1, TIMEOUT, 'estimator_node')
        tables = node.create_publisher(msg.Anchors, 'anchors', qos.LATCHED_LAST)
        for message in messages:
            if message == Request(message.stamp_ns, 1, 6):
                moved = recording.anchors._replace(positions=recording.anchors.positions + 1.0)
                observer.until(lambda: tables.get_subscription_count() == 2, TIMEOUT, 'other tables are heard')
                for table in (recording.anchors, moved):  # of which a slow reader holds the last
                    tables.publish(convert.anchors_message(table, 1))
            feed.send(message, *spoilt(message))
            if isinstance(message, EpochEnd):
                seq = message.request_seq
                reports.publish(msg.TriggerReport(target_id=1, request_seq=seq, sent_ids=[1, 2], sent_seqs=[1]))
                observer.until(lambda seq=seq: any(e.request_seq == seq for e in local), TIMEOUT, f'local_1 of {seq}')
                estimate = convert.estimate_value(local[-1])
                for bad in bad_peers(estimate):
                    peer.publish(convert.estimate_message(bad))
                wrong = convert.estimate_message(estimate)
                wrong.covariance = [1.0]
                peer.publish(wrong)
        observer.until(lambda: any(e.request_seq == EPOCHS - 1 for e in fused), TIMEOUT, 'the last fused estimate')
        observer.until(lambda: counted(observer) == WRONG, TIMEOUT, f'{WRONG}')
        alive = {name: process.poll() is None for name, process in running.items()}
    return local, fused, alive


def test_nodes_live_on(outcome):
    assert outcome[2] == {'sensing': True, 'estimator_1': True}


def test_every_epoch_is_estimated_once_in_order(outcome):
    local, fused, _ = outcome
    assert [e.request_seq for e in local] == list(range(EPOCHS))
    assert [e.request_seq for e in fused] == list(range(EPOCHS))


def test_estimates_are_those_of_the_good_messages_alone(outcome):
    """After the start the robot is found within half a metre, and no bad peer moved the fused estimate."""
    local, fused, _ = outcome
    truth = scenario('a_loop').truth
    for k in range(5, EPOCHS):
        assert np.hypot(*(np.array(local[k].mean[:2]) - truth[k, :2])) < 0.5
        assert list(fused[k].contributors) == [1]
        np.testing.assert_allclose(fused[k].mean, local[k].mean, atol=1e-9)

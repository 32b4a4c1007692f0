"""What the recorder says of what never came, and when it is interrupted."""

from __future__ import annotations

import signal
from contextlib import contextmanager

from wsn_tracking_msgs import msg

import live
from observer import observing
from wsn_tracking import graphs
from wsn_tracking.node_parameters.feeds import RECORDER
from wsn_tracking.nodes import qos

TIMEOUT = 60.0  # [s]


@contextmanager
def alone(folder, **settings):
    """A recorder without a feed that has got two readings: its process, who ends their epoch, and an observer."""
    recorder = graphs.Process('bag_recorder_node', RECORDER, {'output': str(folder), 'loss_timeout': 0.2, **settings})
    with (
        live.private_domain() as environment,
        observing(environment) as observer,
        live.started([recorder], environment) as running,
    ):
        ends = observer.node.create_publisher(msg.EpochEnd, 'epoch_end', qos.FED)
        readings = observer.node.create_publisher(msg.RssiMeasurement, 'rssi', qos.FED)
        observer.until(lambda: ends.get_subscription_count() and readings.get_subscription_count(), TIMEOUT, RECORDER)
        for seq in (4, 6):
            readings.publish(msg.RssiMeasurement(node_id=seq, target_id=1, seq=seq, rssi_dbm=-50.0))
        observer.until(lambda: observer.told(f'/{RECORDER}').get('rssi') == '2', TIMEOUT, 'two readings')
        yield running[RECORDER], ends, observer


def test_a_recorder_says_what_was_listed_and_has_not_come(tmp_path):
    with alone(tmp_path / 'out') as (recorder, ends, _):
        ends.publish(msg.EpochEnd(target_id=1, topic='rssi', node_ids=[4, 5, 6], seqs=[4, 5, 6], final=True))
        output, _ = recorder.communicate(timeout=TIMEOUT)
    assert recorder.returncode == 1
    assert 'rssi: 1 of 3 messages have not come' in output
    assert 'request: 1 of 1 messages have not come' in output


def test_an_interrupted_recorder_finishes_its_bag_and_says_what_it_holds(tmp_path):
    with alone(tmp_path / 'out') as (recorder, *_):
        recorder.send_signal(signal.SIGINT)
        output, _ = recorder.communicate(timeout=TIMEOUT)
    assert recorder.returncode == 0
    assert output.strip() == f"{tmp_path / 'out'}: {{'rssi': 2}}"
    assert 'message_count: 2' in (tmp_path / 'out' / 'metadata.yaml').read_text()


def test_a_recorder_of_estimates_waits_for_the_last_one(tmp_path):
    """However long a tracker takes: silence ends the recording only once the final epoch is answered."""
    patient = {'extra_topics': ['estimate/slow'], 'silence': 0.01, 'loss_timeout': TIMEOUT}
    with alone(tmp_path / 'out', **patient) as (recorder, ends, observer):
        estimates = observer.node.create_publisher(msg.TargetEstimate, 'estimate/slow', qos.ESTIMATES)
        requests = observer.node.create_publisher(msg.LocationRequest, 'request', qos.FED)
        observer.until(
            lambda: estimates.get_subscription_count() and requests.get_subscription_count(), TIMEOUT, RECORDER
        )
        requests.publish(msg.LocationRequest(target_id=1, seq=7))
        listed = {'topic': 'rssi', 'node_ids': [4, 6], 'seqs': [4, 6]}
        ends.publish(msg.EpochEnd(target_id=1, request_seq=7, final=True, **listed))
        estimates.publish(msg.TargetEstimate(target_id=1, request_seq=6))
        observer.until(lambda: observer.told(f'/{RECORDER}').get('estimate/slow') == '1', TIMEOUT, 'the first one')
        assert recorder.poll() is None  # far longer than `silence`
        estimates.publish(msg.TargetEstimate(target_id=1, request_seq=7))
        output, _ = recorder.communicate(timeout=TIMEOUT)
    assert recorder.returncode == 0, output
    assert "'estimate/slow': 2" in output
    assert 'final epoch' not in output


def test_a_recorder_says_which_estimates_did_not_come_to_the_end(tmp_path):
    with alone(tmp_path / 'out', extra_topics=['estimate/none']) as (recorder, ends, _):
        ends.publish(msg.EpochEnd(target_id=1, request_seq=7, topic='rssi', final=True))
        output, _ = recorder.communicate(timeout=TIMEOUT)
    assert recorder.returncode == 1
    assert 'estimate/none did not reach the final epoch of its target: {1: 7}' in output

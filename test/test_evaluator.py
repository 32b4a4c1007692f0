"""evaluator_node in a long run: its diagnostics must leave it time for its inputs, and it must end."""

from __future__ import annotations

import time

import pytest
import rclpy

import live
from wsn_tracking.nodes.base import Finished
from wsn_tracking.nodes.evaluator_node import QUIET, SHARE_OF_TIME, EvaluatorNode
from wsn_tracking.sensing.values import EpochEnd

LONG = 0.05  # [s] that a summary takes


@pytest.fixture
def node():
    with live.private_domain() as environment:
        rclpy.init(domain_id=int(environment['ROS_DOMAIN_ID']))
        made = EvaluatorNode()
        yield made
        made.destroy_node()
        rclpy.try_shutdown()


def test_scores_for_diagnostics_take_a_small_share_of_the_time(node, monkeypatch):
    whole, times = node._summary, []

    def slow():
        times.append(time.monotonic())
        while time.monotonic() < times[-1] + LONG:
            pass
        return whole()

    monkeypatch.setattr(node, '_summary', slow)
    while len(times) < 2:
        assert node.state()['epochs'] == 0
    assert times[1] - times[0] >= LONG / SHARE_OF_TIME


def test_it_ends_with_its_targets_though_another_one_goes_on(node, monkeypatch):
    monkeypatch.setattr(node, '_estimates', {})
    monkeypatch.setattr(node, '_tell', lambda: None)
    node._end(EpochEnd(0, 1, 0, 'rssi', (), (), final=True), 0.0)
    node._finish()
    for k in range(QUIET - 1):
        node._end(EpochEnd(k, 2, k, 'rssi', (), (), final=False), float(k))
        node._finish()
    node._end(EpochEnd(QUIET, 2, QUIET, 'rssi', (), (), final=False), float(QUIET))
    with pytest.raises(Finished):
        node._finish()

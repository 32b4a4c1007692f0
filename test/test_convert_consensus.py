"""Messages of system B are its values, number by number, and come back as they were."""

from __future__ import annotations

import math

import pytest
from rclpy.serialization import deserialize_message, serialize_message
from wsn_tracking_msgs import msg

from wsn_tracking.nodes import convert
from wsn_tracking.sensing.values import RangeBearing
from wsn_tracking.trackers.consensus_share import Share

STAMP = 1_500_000_000_123_456_789
ROW = tuple(0.1 * k for k in range(14))
SHARES = {
    'averaged': Share(STAMP, 65535, 2**32 - 1, 19, 65535, 'icf', 8, b'\x06\x00\x80', ROW[:4], ROW[4:]),
    'forwarded': Share(STAMP, 1, 0, 0, 2, 'flood', 1, b'', (), (), (2, 65535), ROW + ROW),
    'nothing new': Share(STAMP, 1, 0, 4, 2, 'flood', 0, b'\x04'),
}


@pytest.mark.parametrize('name', SHARES)
def test_a_share_survives_the_wire(name):
    sent = serialize_message(convert.share_message(SHARES[name]))
    assert convert.share_value(deserialize_message(sent, msg.ConsensusShare)) == SHARES[name]


@pytest.mark.parametrize(
    'value',
    [
        RangeBearing(STAMP, 50, 1, 7, 8, 123.4, -3.1, (0.01, 0.0, 0.0, 0.25)),
        RangeBearing(STAMP, 50, 1, 7, 8, 0.0, math.pi, (1.0, 0.2, 0.2, 2.0), arrived=False),
    ],
)
def test_an_observation_survives_the_wire(value):
    sent = serialize_message(convert.range_bearing_message(value))
    assert convert.range_bearing_value(deserialize_message(sent, msg.RangeBearing)) == value


def test_a_bearing_that_was_not_measured_stays_unknown():
    value = RangeBearing(STAMP, 1, 1, 0, 0, 5.0, math.nan, (0.01, 0.0, 0.0, 0.25))
    assert math.isnan(convert.range_bearing_value(convert.range_bearing_message(value)).bearing)

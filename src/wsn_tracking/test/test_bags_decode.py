"""The fast path decodes what the typestore decodes, and refuses what it refuses."""

from __future__ import annotations

import numpy as np
import pytest
from bag_cases import NODES, START, anchors, measurement
from hypothesis import given, settings
from hypothesis import strategies as st

from wsn_tracking.bags.decode import MAX_SHAPES, MIN_GROUP, decode
from wsn_tracking.bags.messages import TruthPose, to_cdr, type_of
from wsn_tracking.bags.types import typestore
from wsn_tracking.sensing.values import EpochEnd, TriggerReport


def rows_of(groups):
    """Columns as one dictionary a message, in the order of the messages."""
    table = {}
    for group in groups:
        for k, row in enumerate(group.rows.tolist()):
            assert row not in table
            table[row] = {name: np.asarray(group.columns[name][k]).tolist() for name in sorted(group.columns)}
    return [table[row] for row in sorted(table)]


def assert_equal_paths(type_name, cdrs):
    fast, bad_fast = decode(type_name, cdrs)
    slow, bad_slow = decode(type_name, cdrs, fast=False)
    assert bad_fast == bad_slow
    assert repr(rows_of(fast)) == repr(rows_of(slow))
    return fast, bad_fast


def many(value, count=20):
    return [to_cdr(value._replace(stamp_ns=START + k), START) for k in range(count)]


VALUES = [
    measurement('rssi', START, 1, 3),
    measurement('range', START, 1, 3),
    measurement('observation', START, 2, 3),
    EpochEnd(START, 1, 2, 'rssi', NODES, (4, 5, 6), final=True),
    EpochEnd(START, 1, 2, 'rssi', (), ()),
    TriggerReport(START, 1, 2, (1, 2), (3, 4), (5,), (6,)),
    TruthPose(START, 1, (1.0, 2.0, 3.0), (4.0, 5.0, 6.0)),
]


@pytest.mark.parametrize('value', VALUES, ids=lambda value: type(value).__name__)
def test_one_shape_is_one_group(value):
    fast, bad = assert_equal_paths(type_of(value), many(value))
    assert (len(fast), bad) == (1, 0)


def test_anchors_take_either_path():
    cdrs = [to_cdr(anchors(), START + k) for k in range(8)]
    fast, _ = assert_equal_paths(type_of(anchors()), cdrs)
    assert len(fast) == 1


def test_mixed_shapes_keep_their_places():
    ends = [EpochEnd(START, 1, k, 'rssi', NODES[: k % 4], NODES[: k % 4], k % 5 == 0) for k in range(50)]
    fast, bad = assert_equal_paths(type_of(ends[0]), [to_cdr(end, START) for end in ends])
    assert (len(fast), bad) == (4, 0)
    assert sorted(row for group in fast for row in group.rows.tolist()) == list(range(50))


def test_equal_lengths_with_other_texts_are_other_shapes():
    texts = ['rssi', 'isir', 'ssri']
    ends = [EpochEnd(START, 1, k, texts[k % 3], NODES, NODES) for k in range(30)]
    fast, _ = assert_equal_paths(type_of(ends[0]), [to_cdr(end, START) for end in ends])
    assert len(fast) == 3


def test_more_shapes_than_the_limit_still_decode():
    count = MIN_GROUP * (MAX_SHAPES + 5)
    ends = [EpochEnd(START, 1, k, f'{k % (MAX_SHAPES + 5):04}', NODES, NODES) for k in range(count)]
    fast, bad = assert_equal_paths(type_of(ends[0]), [to_cdr(end, START) for end in ends])
    assert bad == 0
    assert sum(group.rows.size for group in fast) == count


def test_big_endian_messages_decode_equally():
    name = 'wsn_tracking_msgs/msg/RangeMeasurement'
    store = typestore()
    little = many(measurement('range', START, 1, 3))
    big = [bytes(store.serialize_cdr(store.deserialize_cdr(cdr, name), name, little_endian=False)) for cdr in little]
    assert repr(rows_of(decode(name, big)[0])) == repr(rows_of(decode(name, little)[0]))


@settings(max_examples=150)
@given(which=st.integers(0, len(VALUES) - 1), data=st.data())
def test_damaged_messages_are_judged_equally_by_both_paths(which, data):
    value = VALUES[which]
    cdrs = many(value, 12)
    for _ in range(data.draw(st.integers(1, 6))):
        row = data.draw(st.integers(0, len(cdrs) - 1))
        at = data.draw(st.integers(0, max(len(cdrs[row]) - 1, 0)))
        kind = data.draw(st.sampled_from(['flip', 'cut', 'grow']))
        if kind == 'flip' and cdrs[row]:
            changed = bytearray(cdrs[row])
            changed[at] = data.draw(st.integers(0, 255))
            cdrs[row] = bytes(changed)
        elif kind == 'cut':
            cdrs[row] = cdrs[row][:at]
        else:
            cdrs[row] += bytes(data.draw(st.integers(1, 9)))
    assert_equal_paths(type_of(value), cdrs)

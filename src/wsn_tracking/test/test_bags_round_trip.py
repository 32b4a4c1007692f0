"""Everything that is written to a bag is read from it again, equal."""

from __future__ import annotations

import math
import tempfile
from pathlib import Path

import numpy as np
import pytest
from bag_cases import NODES, START, anchors, events, mcap_of, write
from hypothesis import given, settings
from hypothesis import strategies as st

from wsn_tracking.bags.decode import decode
from wsn_tracking.bags.messages import TruthPose, estimates_of, to_cdr
from wsn_tracking.bags.read import raw_messages, read
from wsn_tracking.bags.types import ESTIMATE
from wsn_tracking.bags.write import BagWriter
from wsn_tracking.errors import TrackingError
from wsn_tracking.sensing.values import NAN, EpochEnd, Range, RangeBearing, Request, Rssi, TriggerReport
from wsn_tracking.trackers.estimate import Estimate

stamps = st.integers(0, 2**31 * 10**9 - 1)
u8, u16, u32 = st.integers(0, 2**8 - 1), st.integers(0, 2**16 - 1), st.integers(0, 2**32 - 1)
real = st.floats(allow_nan=True, allow_infinity=True)
ids = st.lists(u16, max_size=9)


def tuples(elements, size):
    return st.lists(elements, min_size=size, max_size=size).map(tuple)


requests = st.builds(Request, stamps, u16, u32)
rssis = st.builds(Rssi, stamps, u16, u16, u32, u32, real, real, u16)
ranges = st.builds(Range, stamps, u16, u16, u32, u32, u8, real, real, real, u16)
bearings = st.builds(RangeBearing, stamps, u16, u16, u32, u32, real, real, tuples(real, 4), st.booleans())
ends = ids.flatmap(
    lambda nodes: st.builds(
        EpochEnd, stamps, u16, u32, st.just('range'), st.just(tuple(nodes)), tuples(u32, len(nodes)), st.booleans()
    )
)
reports = ids.flatmap(
    lambda nodes: st.builds(
        TriggerReport,
        stamps,
        u16,
        u32,
        st.just(tuple(nodes)),
        tuples(u32, len(nodes)),
        st.just(tuple(nodes[:3])),
        tuples(u8, len(nodes[:3])),
    )
)
topic_of = {
    Request: 'request',
    Rssi: 'rssi',
    Range: 'range',
    RangeBearing: 'observation',
    EpochEnd: 'epoch_end',
    TriggerReport: 'trigger_report',
}


def equal(a, b):
    """Equal values, NaN being equal to itself."""
    return repr(a) == repr(b) and type(a) is type(b)


@settings(max_examples=40)
@given(
    values=st.lists(st.one_of(requests, ranges, ends, reports), min_size=1, max_size=30),
    level=st.sampled_from(['range']),
)
def test_values_come_back_equal_and_in_order(values, level):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / 'bag'
        with BagWriter(path, {'entry_level': level}) as bag:
            bag.write('anchors', anchors(), START)
            for k, value in enumerate(values):
                bag.write(topic_of[type(value)], value, START + k)
        back = read(path)
    assert back.dropped == {}
    assert len(back.messages) == len(values)
    assert all(map(equal, back.messages, values))


@settings(max_examples=30)
@given(values=st.one_of(st.lists(rssis, min_size=1, max_size=12), st.lists(bearings, min_size=1, max_size=12)))
def test_the_other_levels_come_back_equal(values):
    level = topic_of[type(values[0])]
    with tempfile.TemporaryDirectory() as folder:
        path = write(Path(folder) / 'bag', [('anchors', anchors(), 5), *((level, value, 7) for value in values)])
        back = read(path)
    assert back.entry_level == level
    assert all(map(equal, back.messages, values))
    assert len(back.messages) == len(values)


@settings(max_examples=30)
@given(n=st.integers(1, 6), data=st.data())
def test_estimates_come_back_equal(n, data):
    numbers = st.floats(-1e6, 1e6)
    mean = np.array(data.draw(st.lists(numbers, min_size=n, max_size=n)))
    covariance = np.array(data.draw(st.lists(numbers, min_size=n * n, max_size=n * n))).reshape(n, n)
    names = tuple(f'state_{i}' for i in range(n))
    value = Estimate(START, 3, 9, 'fused_1', mean, covariance, (1, 2), (4, 9, 11), NAN, 1, names)
    (back,) = estimates_of(decode(ESTIMATE, [to_cdr(value, 0)])[0][0].columns)
    assert back._replace(mean=0, covariance=0) == value._replace(mean=0, covariance=0, q=back.q)
    assert math.isnan(back.q)
    np.testing.assert_array_equal(back.mean, mean)
    np.testing.assert_array_equal(back.covariance, covariance)


def test_anchors_and_truth_come_back_equal(tmp_path):
    back = read(write(tmp_path / 'bag', events('rssi', epochs=6)))
    for name, column in anchors()._asdict().items():
        np.testing.assert_array_equal(getattr(back.anchors, name), column)
    truth = back.truth[1]
    np.testing.assert_array_equal(truth.positions, [[0.1 * k, 1.0, 1.8] for k in range(6)])
    np.testing.assert_array_equal(truth.velocities, [[0.1, 0.0, 0.0]] * 6)
    assert np.all(np.diff(truth.stamps_ns) == 10**9)


def test_an_unknown_velocity_stays_unknown(tmp_path):
    poses = [('truth/target_7', TruthPose(START + k, 7, (1.0, 2.0, 3.0)), START + k) for k in range(5)]
    back = read(write(tmp_path / 'bag', [*events(), *poses]))
    assert np.all(np.isnan(back.truth[7].velocities))
    assert not np.any(np.isnan(back.truth[7].positions))


def test_a_turned_child_frame_is_turned_back(tmp_path):
    from wsn_tracking.bags.types import typestore

    store = typestore()
    raw = to_cdr(TruthPose(START, 1, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)), START)
    message = store.deserialize_cdr(raw, 'nav_msgs/msg/Odometry')
    turn = math.radians(90.0) / 2.0  # the child looks along the map's y
    message.pose.pose.orientation.z, message.pose.pose.orientation.w = math.sin(turn), math.cos(turn)
    path = write(tmp_path / 'bag', [row for row in events() if not row[0].startswith('truth')])
    with BagWriter(tmp_path / 'turned', {'entry_level': 'rssi'}) as bag:
        for kept in raw_messages(path):
            bag.write_raw(kept.topic, kept.type_name, kept.cdr, kept.log_ns)
        cdr = bytes(store.serialize_cdr(message, 'nav_msgs/msg/Odometry'))
        bag.write_raw('truth/target_1', 'nav_msgs/msg/Odometry', cdr, START)
    np.testing.assert_allclose(read(tmp_path / 'turned').truth[1].velocities, [[0.0, 1.0, 0.0]], atol=1e-12)


def test_two_bags_of_equal_values_are_equal_byte_by_byte(tmp_path):
    first, second = (write(tmp_path / folder / 'bag', events('range')) for folder in ('a', 'b'))
    assert mcap_of(first).read_bytes() == mcap_of(second).read_bytes()
    assert (first / 'metadata.yaml').read_bytes() == (second / 'metadata.yaml').read_bytes()


@settings(max_examples=60)
@given(
    metadata=st.dictionaries(
        st.text(st.characters(codec='utf-8', exclude_categories=['C']), min_size=1, max_size=9),
        st.text(st.characters(codec='utf-8', exclude_categories=['C']), max_size=40),
        max_size=4,
    )
)
def test_metadata_come_back_as_text_from_folder_and_file(metadata):
    metadata = {**metadata, 'entry_level': 'rssi'}
    with tempfile.TemporaryDirectory() as folder:
        path = write(Path(folder) / 'bag', events(epochs=1), metadata)
        assert read(path).metadata == metadata
        assert read(mcap_of(path)).metadata == metadata


@pytest.mark.parametrize(
    'value',
    [
        Request(START, 70_000, 1),
        Request(START, 1, -1),
        Request(2**63, 1, 1),
        Rssi(START, 1, 1, 1, 1, 'loud'),
        EpochEnd(START, 1, 1, 'rssi', (1, 70_000), (1, 2)),
        EpochEnd(START, 1, 1, 'rssi', (1,), (-1,)),
    ],
)
def test_a_value_that_does_not_fit_is_refused_with_its_type(value):
    with pytest.raises(TrackingError, match=r'does not fit into wsn_tracking_msgs/msg/'):
        to_cdr(value, START)


def test_a_value_of_no_message_is_refused():
    with pytest.raises(TrackingError, match='int is no value'):
        to_cdr(3, START)


def test_every_node_is_in_the_bag(tmp_path):
    back = read(write(tmp_path / 'bag', events('rssi')))
    assert {m.node_id for m in back.messages if isinstance(m, Rssi)} == set(NODES)

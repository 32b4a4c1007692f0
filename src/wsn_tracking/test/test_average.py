"""Several packets of a node within an epoch become one measurement, exactly the same in every order."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wsn_tracking.sensing.average import one_a_node, unusable, usable
from wsn_tracking.sensing.values import Range, RangeBearing, Rssi

NAN = math.nan
numbers = st.floats(allow_nan=True, allow_infinity=True, width=64)


def rssi(seq, dbm, sigma=1.5, n=1, node=1):
    return Rssi(100 + seq, node, 1, seq, 0, dbm, sigma, n)


def ranged(seq, metres, variance=0.04, n=1, beside=-50.0, node=1):
    return Range(100 + seq, node, 1, seq, 0, 1, metres, variance, beside, n)


def bearing(seq, arrived=True):
    return RangeBearing(100 + seq, 1, 1, seq, 0, 1.0 + seq, NAN, (1.0, 0.0, 0.0, 1.0), arrived)


def test_one_packet_is_itself():
    assert one_a_node([rssi(0, -50.0)]) == (rssi(0, -50.0),)
    assert one_a_node([]) == ()


def test_signal_strengths_are_averaged_by_their_samples():
    (mean,) = one_a_node([rssi(4, -50.0, 2.0, 3), rssi(5, -58.0, 1.0, 1)])
    assert mean == Rssi(105, 1, 1, 5, 0, -52.0, math.sqrt(37.0) / 4.0, 4)  # stamp and seq of the last


def test_ranges_are_averaged_by_their_samples():
    (mean,) = one_a_node([ranged(4, 2.0, 0.04, 3, -50.0), ranged(5, 4.0, 0.01, 1, -54.0)])
    assert mean[:6] == (105, 1, 1, 5, 0, 1)
    assert mean.range == pytest.approx(2.5)
    assert mean.variance == pytest.approx((9 * 0.04 + 0.01) / 16)
    assert (mean.rssi_dbm, mean.n_samples) == (-51.0, 4)


def test_what_is_not_known_of_one_packet_is_not_known_of_the_mean():
    (mean,) = one_a_node([ranged(0, 2.0, NAN, beside=math.inf), ranged(1, 4.0)])
    assert mean.range == 3.0
    assert math.isnan(mean.variance)
    assert math.isnan(mean.rssi_dbm)
    (mean,) = one_a_node([rssi(0, -50.0, NAN), rssi(1, -52.0)])
    assert (mean.rssi_dbm, math.isnan(mean.sigma_db)) == (-51.0, True)


@pytest.mark.parametrize('nonsense', [127.0, -128.0, NAN, math.inf, -math.inf])
def test_a_value_that_cannot_be_true_does_not_spoil_the_others(nonsense):
    """The mean of -128 (no value) and -60 would look like a weak signal."""
    (mean,) = one_a_node([rssi(0, -60.0), rssi(1, nonsense), rssi(2, -62.0)])
    assert (mean.rssi_dbm, mean.n_samples, mean.seq) == (-61.0, 2, 2)
    (mean,) = one_a_node([ranged(0, 2.0), ranged(1, abs(nonsense) * 1e3), ranged(2, 3.0)])
    assert (mean.range, mean.n_samples) == (2.5, 2)


def test_nonsense_alone_stays_for_the_reader_to_refuse():
    (last,) = one_a_node([rssi(0, 127.0), rssi(1, -128.0)])
    assert last == rssi(1, -128.0)
    assert unusable([rssi(0, 127.0), rssi(1, -60.0), last]) == 2


def test_the_latest_bearing_that_arrived_counts():
    assert one_a_node([bearing(0), bearing(2, arrived=False), bearing(1)]) == (bearing(1),)


def test_no_samples_count_as_one():
    (mean,) = one_a_node([rssi(0, -50.0, n=0), rssi(1, -52.0, n=0)])
    assert (mean.rssi_dbm, mean.n_samples) == (-51.0, 2)


@pytest.mark.parametrize(
    ('packet', 'verdict'),
    [
        (rssi(0, -127.0), True),
        (rssi(0, 20.0), True),
        (rssi(0, -127.1), False),
        (rssi(0, 20.1), False),
        (rssi(0, -50.0, NAN), True),
        (rssi(0, -50.0, 0.0), False),
        (rssi(0, -50.0, -1.0), False),
        (rssi(0, -50.0, math.inf), False),
        (ranged(0, 1e-3), True),
        (ranged(0, 0.0), False),
        (ranged(0, 1e-300), False),
        (ranged(0, -1.0), False),
        (ranged(0, 1e5), False),
        (ranged(0, 1.0, NAN), True),
        (ranged(0, 1.0, 0.0), False),
        (ranged(0, 1.0, math.inf), False),
        (bearing(0, arrived=False), True),
    ],
)
def test_a_packet_is_usable_if_it_can_be_true(packet, verdict):
    assert usable(packet) is verdict


packets = st.lists(
    st.one_of(
        st.builds(rssi, st.integers(0, 3), numbers, numbers, st.integers(0, 65535), st.integers(1, 2)),
        st.builds(rssi, st.integers(0, 3), st.floats(-127, 20), st.floats(0.1, 9), st.integers(0, 9), node=st.just(2)),
        st.builds(ranged, st.integers(0, 3), numbers, numbers, st.integers(0, 65535), numbers, st.integers(3, 4)),
        st.builds(ranged, st.integers(0, 3), st.floats(0.1, 50), st.floats(0.1, 9), node=st.integers(3, 4)),
    ),
    unique_by=lambda p: (p.node_id, p.seq),
    max_size=8,
)


@given(packets, st.randoms(use_true_random=False))
@settings(max_examples=200)
def test_the_order_of_arrival_changes_no_bit(given_, rng):
    """For any numbers at all, and no number makes it fail."""
    shuffled = list(given_)
    rng.shuffle(shuffled)
    averaged = one_a_node(given_)
    assert repr(one_a_node(shuffled)) == repr(averaged)  # repr: NaN does not equal itself
    assert [p.node_id for p in averaged] == sorted({p.node_id for p in given_})
    for mean in averaged:
        same = [p for p in given_ if p.node_id == mean.node_id]
        good = [p for p in same if usable(p)]
        assert usable(mean) == bool(good)
        if good:
            value = (lambda p: p.rssi_dbm) if isinstance(mean, Rssi) else (lambda p: p.range)
            slack = 1e-9 * max(abs(value(p)) for p in good)
            assert min(map(value, good)) - slack <= value(mean) <= max(map(value, good)) + slack
            assert mean.n_samples == (sum(max(p.n_samples, 1) for p in good) if len(good) > 1 else good[0].n_samples)

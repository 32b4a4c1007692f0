"""What a local estimator of system A reads: ranges and signal strengths, with their noise."""

import math

import numpy as np
from oracles import LOOP, NOISE, H
from random_q_cases import IDS, MEAN, STD, Z, epoch

from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.srckf import update
from wsn_tracking.models.measurement import constant_noise, log_range_function
from wsn_tracking.models.radio import rssi_at
from wsn_tracking.sensing.values import Epoch, Modality, Range, RangeBearing, Rssi
from wsn_tracking.trackers.random_q_config import UpdateConfig
from wsn_tracking.trackers.readings import MeasurementTable

TOLD = np.where(np.arange(12) % 3 == 0, np.nan, Z)


def read(measurements, **options):
    return MeasurementTable(LOOP.anchors, 0.0, UpdateConfig(**options)).read(Epoch(1, 0, 0, tuple(measurements)))


def test_rssi_ranges_have_the_noise_of_the_measured_or_of_the_predicted_range():
    x = LOOP.truth[50:52]
    heard = ~np.isnan(TOLD)
    z, h, noise, ids = read(epoch(0, TOLD).measurements, r='measured')
    np.testing.assert_array_equal(z, TOLD)
    np.testing.assert_allclose(h(x), H(x))
    np.testing.assert_allclose(noise(x)[0, heard], NOISE(LOOP.truth[5])[heard])
    assert ids == tuple(np.array(IDS)[heard])
    z, h, noise, _ = read(epoch(0, TOLD).measurements, r='predicted')
    np.testing.assert_allclose(noise(x)[:, heard], NOISE(x)[:, heard])


def test_a_told_variance_counts_more_than_the_table():
    told = epoch(0, Z, variance=0.04).measurements
    x = LOOP.truth[:1]
    np.testing.assert_allclose(read(told, r='measured')[2](x)[0], 0.2)
    np.testing.assert_allclose(read(told, r='predicted')[2](x)[0], 0.2 / Z * H(x)[0])


def test_logarithms_of_ranges_have_an_even_noise():
    z, h, noise, _ = read(epoch(0, TOLD).measurements, kind='log')
    heard, x = ~np.isnan(TOLD), LOOP.truth[50:52]
    np.testing.assert_allclose(z[heard], np.log(TOLD[heard]))
    np.testing.assert_allclose(h(x), log_range_function(LOOP.anchors)(x))
    np.testing.assert_allclose(noise(x)[0, heard], 1.56 * math.log(10.0) / 30.0)


def test_ranging_radios_have_a_noise_that_does_not_grow():
    told = epoch(0, Z, modality=Modality.UWB).measurements
    _, _, noise, _ = read(told, range_std=0.3)
    np.testing.assert_allclose(noise(LOOP.truth[:2])[0], 0.3)
    _, _, noise, _ = read(epoch(0, Z, modality=Modality.UWB, variance=0.01).measurements)
    np.testing.assert_allclose(noise(LOOP.truth[:2])[0], 0.1)


def test_signal_strengths_are_filtered_in_decibel():
    y = rssi_at(LOOP.anchors, Z)
    told = [Rssi(0, i, 1, 0, 0, float(v)) for i, v in zip(IDS, y, strict=True)]
    told[2] = told[2]._replace(sigma_db=4.0)
    z, h, noise, ids = read(told[:6])
    np.testing.assert_allclose(z[:6], y[:6])
    assert np.isnan(z[6:]).all()
    np.testing.assert_allclose(h(LOOP.truth[5]), y)
    np.testing.assert_allclose(noise(LOOP.truth[5:6])[0], np.where(np.arange(12) == 2, 4.0, 1.56))
    assert ids == tuple(IDS[:6])


def test_unusable_packets_and_unknown_nodes_are_left_out():
    nan, good = math.nan, Range(0, 3, 1, 0, 0, Modality.RSSI, 1.0)
    bad = [
        good._replace(node_id=1, range=nan),
        good._replace(node_id=2, range=0.0),
        good._replace(node_id=4, range=math.inf),
        good._replace(node_id=5, variance=0.0),
        good._replace(node_id=900),
        RangeBearing(0, 6, 1, 0, 0, 1.0, 0.0, (1.0, 0.0, 0.0, 1.0), arrived=False),
    ]
    z, _, _, ids = read([*bad, good])
    assert ids == (3,)
    assert np.isfinite(z).tolist() == [i == 3 for i in IDS]
    assert read(bad)[3] == ()
    weird = Rssi(0, 3, 1, 0, 0, -60.0)
    bad_rssi = [weird._replace(rssi_dbm=127.0), weird._replace(rssi_dbm=nan), weird._replace(sigma_db=0.0)]
    assert read(bad_rssi)[3] == ()


def test_of_range_and_bearing_the_range_counts():
    seen = RangeBearing(0, 6, 1, 0, 0, 1.25, 0.3, (0.04, 0.0, 0.0, 1.0))
    z, h, noise, ids = read([seen])
    alone = read([Range(0, 6, 1, 0, 0, Modality.OTHER, 1.25, 0.04)])
    assert ids == (6,)
    np.testing.assert_array_equal(z, alone[0])
    states = np.array([[1.0, 0.5, 0.0, 0.0], [2.0, 2.0, 0.1, 0.0]])
    np.testing.assert_array_equal(h(states), alone[1](states))
    np.testing.assert_array_equal(noise(states), alone[2](states))
    assert read([seen._replace(bearing=math.nan)])[3] == (6,)


def test_an_epoch_of_nothing_leaves_the_belief_alone():
    belief = Belief(np.array(MEAN), np.diag(STD))
    for options in ({}, {'kind': 'log'}, {'r': 'measured'}):
        z, h, noise, ids = read([], **options)
        assert ids == ()
        np.testing.assert_array_equal(update(belief, z, h, noise, 2).m, belief.m)


def test_constant_noise_of_a_batch_has_its_batch():
    assert constant_noise(np.ones((7, 12)))(np.zeros((7, 8, 4))).shape == (7, 1, 12)

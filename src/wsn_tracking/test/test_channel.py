"""Calibrated radios replace those of the anchors, and who estimates uses them."""

from __future__ import annotations

import logging

import numpy as np
import pytest
from channel_cases import IDS, POSITIONS, a_channel, saved

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.models.measurement import rssi_function
from wsn_tracking.models.radio_map import residual
from wsn_tracking.sensing.channel import apply, lacking
from wsn_tracking.sensing.channel_file import calibrated, load_channel
from wsn_tracking.sensing.values import Epoch, Range, Rssi
from wsn_tracking.trackers.estimator import EstimatorConfig, make_estimator


def test_the_radio_replaces_that_of_the_anchors():
    channel = a_channel()
    anchors = make_anchors(IDS, POSITIONS, p1_dbm=-40.0, d0=2.0, n=4.0, sigma_db=9.0, bias=5.0, scale=2.0)
    ours = apply(channel, anchors)
    assert np.array_equal(ours.p1_dbm, channel.path_loss.p1_dbm.value)
    assert np.array_equal(ours.n, channel.path_loss.n.value)
    assert np.array_equal(ours.sigma_db, channel.path_loss.sigma_db.value)
    assert ours.d0.tolist() == [1.0, 1.0, 1.0]
    assert ours.bias.tolist() == [0.1, -0.2, 0.0]
    assert ours.scale.tolist() == [1.0, 1.07, 0.99]
    assert np.array_equal(ours.positions, anchors.positions)
    only = apply(channel._replace(path_loss=None), anchors)
    assert np.array_equal(only.p1_dbm, anchors.p1_dbm)
    assert only.scale.tolist() == [1.0, 1.07, 0.99]


def test_nodes_that_the_file_lacks_keep_their_radio_and_that_is_said(tmp_path, caplog):
    path = saved(tmp_path)
    anchors = make_anchors([2, 7, 20], POSITIONS, p1_dbm=-40.0, d0=2.0)
    with caplog.at_level(logging.WARNING):
        ours, radio_map = calibrated(path, anchors)
    assert 'lacks nodes [2]' in caplog.text
    assert ours.p1_dbm[0] == -40.0
    assert ours.d0.tolist() == [2.0, 1.0, 1.0]
    assert ours.bias.tolist() == [0.0, -0.2, 0.0]
    assert radio_map is not None
    assert lacking(a_channel(), anchors) == (2,)


def test_more_nodes_than_the_anchors_have_do_no_harm(tmp_path, caplog):
    path = saved(tmp_path)
    ours, _ = calibrated(path, make_anchors([20], [POSITIONS[2]]))
    assert ours.scale.tolist() == [0.99]
    assert not caplog.text
    anchors = make_anchors(IDS, POSITIONS)
    assert calibrated('', anchors) == (anchors, None)


def test_a_calibration_for_other_nodes_is_refused(tmp_path):
    path = saved(tmp_path)
    with pytest.raises(TrackingError, match=r'channel.yaml.*nodes \[3, 7, 20\], none of which .* \[1, 2\]'):
        calibrated(path, make_anchors([1, 2], POSITIONS[:2]))


def packet(node, rssi, sigma=np.nan):
    return Rssi(0, node, 1, 0, 0, rssi, sigma)


def test_an_estimator_filters_signal_strengths_with_the_map(tmp_path):
    path = saved(tmp_path)
    anchors = make_anchors(IDS, POSITIONS, p1_dbm=-40.0)
    local, _ = make_estimator(EstimatorConfig(channel=path, nodes=(3, 20), target_height=1.0), anchors)
    heard = local.table.read(Epoch(1, 0, 0, (packet(3, -60.0), packet(20, -61.0, 9.0))))
    x = np.array([[2.0, 3.0, 0.0, 0.0], [5.0, 1.0, 0.0, 0.0]])
    radio_map = load_channel(path).radio_map
    mean, std = (part[:, [0, 2]] for part in residual(radio_map, x))
    own = make_anchors([3, 20], [POSITIONS[0], POSITIONS[2]], p1_dbm=radio_map.p1_dbm[[0, 2]], n=radio_map.n[[0, 2]])
    np.testing.assert_allclose(heard.h(x), rssi_function(own, 1.0)(x) + mean)
    packets = np.array([radio_map.packet_db[0], 9.0])  # what comes along counts before what is calibrated
    np.testing.assert_allclose(heard.noise(x) ** 2, std**2 + radio_map.place_db[[0, 2]] ** 2 + packets**2)


def test_the_map_leaves_ranges_alone(tmp_path):
    path = saved(tmp_path)
    anchors = make_anchors(IDS, POSITIONS)
    mapped, _ = make_estimator(EstimatorConfig(channel=path), anchors)
    plain, _ = make_estimator(EstimatorConfig(), apply(load_channel(path), anchors))
    epoch = Epoch(1, 0, 0, (Range(0, 3, 1, 0, 0, 1, 4.0), Range(0, 7, 1, 0, 0, 1, 5.0)))
    x = np.array([[2.0, 3.0, 0.0, 0.0]])
    ours, theirs = mapped.table.read(epoch), plain.table.read(epoch)
    np.testing.assert_array_equal(ours.h(x), theirs.h(x))
    np.testing.assert_array_equal(ours.noise(x), theirs.noise(x))

"""What the tracker of a person reads: signal strengths, and ranges as if they were such."""

import math
from dataclasses import replace

import numpy as np
import pytest
from human_cases import ANCHORS, EPOCHS, FEW, TRUTH, packet

from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.models.body import LOS, NLOS, SINGLE
from wsn_tracking.sensing.values import Epoch, Modality, Range
from wsn_tracking.simulation.record import START_NS, TARGET
from wsn_tracking.trackers.human import HumanTracker
from wsn_tracking.trackers.human_config import HumanConfig, SignalConfig
from wsn_tracking.trackers.human_readings import SignalTable


def test_a_range_is_log_normal_about_the_distance():
    """z of the single curve at the range; a deviation of 10 % is 0.1 x 23.95 / ln 10 dB."""
    table = SignalTable(HumanConfig(), ANCHORS, HumanTracker(FEW, ANCHORS).counters)
    ranges = (
        Range(START_NS, 1, TARGET, 0, 0, Modality.UWB, 20.0, 4.0),
        Range(START_NS, 2, TARGET, 0, 0, Modality.UWB, 20.0),
        Range(START_NS, 3, TARGET, 0, 0, Modality.RSSI, 20.0, 4.0, -72.0),
        Range(START_NS, 4, TARGET, 0, 0, Modality.RSSI, 20.0),
    )
    readings, ids = table.read(Epoch(TARGET, 0, START_NS, ranges))
    assert ids == (1, 2, 3, 4)
    at_20_m = SINGLE.p_ref + SINGLE.k * math.log10(20.0)
    np.testing.assert_allclose(readings.z[:4], [at_20_m, at_20_m, -72.0, at_20_m])
    assert readings.sigma[0] == pytest.approx(0.1 * 23.95 / math.log(10.0))
    assert readings.sigma[1] == 0.5  # 0.1 m: less than particles can tell apart
    assert readings.sigma[2] == pytest.approx(0.1 * 23.95 / math.log(10.0))
    assert readings.sigma[3] == 3.0
    np.testing.assert_allclose(readings.curves.los.p_ref[:4], [SINGLE.p_ref, SINGLE.p_ref, LOS.p_ref, LOS.p_ref])
    np.testing.assert_allclose(readings.curves.nlos.k[:4], [SINGLE.k, SINGLE.k, NLOS.k, NLOS.k])


def test_scale_and_bias_of_a_ranging_radio_are_taken_off():
    anchors = make_anchors([1], [[0.0, 0.0]], scale=1.5, bias=2.0)
    table = SignalTable(HumanConfig(), anchors, HumanTracker(FEW, ANCHORS).counters)
    readings, _ = table.read(Epoch(TARGET, 0, START_NS, (Range(START_NS, 1, TARGET, 0, 0, Modality.UWB, 17.0, 1.0),)))
    assert readings.z[0] == pytest.approx(-45.0 - 30.0)


def test_it_follows_ranges_as_well():
    tracker = HumanTracker(replace(FEW, particles=500), ANCHORS)
    rng = np.random.default_rng(1)
    errors = []
    for k, epoch in enumerate(EPOCHS):
        d = np.hypot(*(ANCHORS.positions[:, :2] - TRUTH[k, :2]).T) * (1.0 + 0.05 * rng.standard_normal(16))
        packets = tuple(
            Range(epoch.stamp_ns, i + 1, TARGET, k, k, Modality.ULTRASOUND, d[i], (0.05 * d[i]) ** 2) for i in range(16)
        )
        errors.append(np.hypot(*(tracker.step(epoch._replace(measurements=packets))[0].mean[:2] - TRUTH[k, :2])))
    assert np.sqrt(np.mean(np.square(errors[5:]))) < 2.0  # 5 % of 40 m, what one range errs by


def test_deviations_are_the_packets_else_the_nodes_unless_they_are_set():
    def sigma(config):
        table = SignalTable(config, ANCHORS, HumanTracker(FEW, ANCHORS).counters)
        return table.read(Epoch(TARGET, 0, START_NS, (packet(1, -60.0, sigma=4.0), packet(2, -60.0))))[0].sigma[:2]

    np.testing.assert_allclose(sigma(HumanConfig()), [4.0, 3.0])
    np.testing.assert_allclose(sigma(HumanConfig(signal=SignalConfig(sigma=5.0))), [5.0, 5.0])
    np.testing.assert_allclose(sigma(HumanConfig(profile='rss_mcl')), np.hypot([4.0, 3.0], 5.6))

"""Nothing that is heard, and no step of time, leads an estimate astray: it stays finite and within the area."""

from dataclasses import replace

import numpy as np
import pytest
from human_cases import ANCHORS, AREA, EPOCHS, FEW, NONSENSE, PROFILE, SECOND, bounded, epochs, packet, run
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles import properties

from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.sensing.values import Epoch
from wsn_tracking.simulation.c_body import BodyConfig
from wsn_tracking.simulation.record import START_NS, TARGET
from wsn_tracking.trackers.human import HumanTracker
from wsn_tracking.trackers.human_config import (
    PROFILES,
    HumanConfig,
    MotionConfig,
    ResamplingConfig,
    SignalConfig,
    StartConfig,
)


@PROFILE
@pytest.mark.parametrize('kind', sorted(NONSENSE))
def test_nonsense_leaves_finite_bounded_estimates(profile, kind):
    tracker = HumanTracker(replace(FEW, profile=profile, lag=1.0), ANCHORS)
    run(tracker, EPOCHS[:3])
    for k in range(6):
        bounded(tracker.step(Epoch(TARGET, 3 + k, EPOCHS[3 + k].stamp_ns, NONSENSE[kind](k))))
        tracker.state()
    if kind == 'impossible':
        assert tracker.counters['unusable'] == 4 * 6
    if kind == 'strangers':
        assert (tracker.counters['unknown_node'], tracker.counters['unusable']) == (6, 0)


@PROFILE
@pytest.mark.parametrize('positions', [[[3.0, 3.0]] * 4, [[3.0, 3.0], [4.0, 3.0], [5.0, 3.0], [6.0, 3.0]]])
def test_nodes_at_one_place_or_on_one_line_leave_finite_bounded_estimates(profile, positions):
    anchors = make_anchors([1, 2, 3, 4], positions)
    tracker = HumanTracker(HumanConfig(profile=profile, particles=200, start=StartConfig(draws=500)), anchors)
    for k in range(8):
        packets = tuple(packet(i, -55.0 - i) for i in (1, 2, 3, 4))
        bounded(tracker.step(Epoch(TARGET, k, START_NS + k * SECOND, packets)), tracker._filter.area)


@PROFILE
@pytest.mark.parametrize('dt_ns', [0, -SECOND, 1, 40 * SECOND, 3600 * SECOND])
def test_no_step_of_time_leads_an_estimate_out_of_the_area(profile, dt_ns):
    tracker = HumanTracker(replace(FEW, profile=profile, lag=1.0), ANCHORS)
    run(tracker, EPOCHS[:4])
    jump = EPOCHS[3].stamp_ns + dt_ns - EPOCHS[4].stamp_ns
    for epoch in EPOCHS[4:9]:
        bounded(tracker.step(epoch._replace(stamp_ns=epoch.stamp_ns + jump)))
    assert tracker.counters['started_after_gap'] == (dt_ns > 60 * SECOND)


def test_no_time_moves_nobody():
    tracker = HumanTracker(FEW, ANCHORS)
    run(tracker, EPOCHS[:4])
    silent = EPOCHS[4]._replace(measurements=(), stamp_ns=EPOCHS[3].stamp_ns)
    before = tracker._track.cloud.s
    tracker.step(silent)
    np.testing.assert_array_equal(np.unique(tracker.particles.positions, axis=0), np.unique(before[:2].T, axis=0))


def test_a_target_outside_the_area_stays_at_its_border():
    tracker = HumanTracker(replace(FEW, area=(0.0, 0.0, 50.0, 50.0)), ANCHORS)
    sequence, truth = epochs(BodyConfig(duration=30.0), 5)
    assert np.any(truth[:, :2] > 60.0)
    for epoch in sequence:
        bounded(tracker.step(epoch), (0.0, 0.0, 50.0, 50.0))


@settings(properties, max_examples=40)
@given(
    seed=st.integers(0, 10_000),
    profile=st.sampled_from(sorted(PROFILES)),
    dof=st.sampled_from([0.0, 3.0]),
    motion=st.sampled_from(['profile', 'random_walk']),
    kind=st.sampled_from(['systematic', 'stratified', 'multinomial', 'residual']),
)
def test_estimates_stay_bounded_whatever_is_read_and_when(seed, profile, dof, motion, kind):
    rng = np.random.default_rng(seed)
    config = HumanConfig(
        profile=profile,
        particles=50,
        area=AREA,
        lag=2.0,
        signal=SignalConfig(dof=dof),
        motion=MotionConfig(kind=motion),
        resampling=ResamplingConfig(kind=kind, kld=float(rng.choice([0.0, 0.1]))),
        start=StartConfig(draws=60, gap=20.0),
    )
    tracker, stamp = HumanTracker(config, ANCHORS), START_NS
    for k in range(6):
        stamp += int(rng.choice([0, 1, SECOND // 2, 5 * SECOND, 30 * SECOND, -SECOND]))
        heard = rng.choice(16, rng.integers(0, 17), replace=False) + 1
        packets = tuple(packet(int(i), float(rng.uniform(-130.0, 25.0))) for i in np.sort(heard))
        bounded(tracker.step(Epoch(TARGET, k, stamp, packets)))

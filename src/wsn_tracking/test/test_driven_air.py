"""The second robot behind a simulated sink: it is where the sink's feedback makes it drive, and that is measured."""

from __future__ import annotations

import numpy as np
import pytest

from wsn_tracking.bags.messages import TruthPose
from wsn_tracking.bags.write import BagWriter
from wsn_tracking.driven_air import DrivenAir, DrivenConfig
from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.sensing.values import EpochEnd, Request
from wsn_tracking.simulation import d_cells
from wsn_tracking.simulation.d_cells import CellsConfig
from wsn_tracking.simulation.driven import FIRST, SECOND, FollowConfig, phase_error
from wsn_tracking.studies.phase_recorded import phase_run
from wsn_tracking.trackers.estimate import PLANAR_STATES, Estimate, Kind
from wsn_tracking.zstack.downlink import Told
from wsn_tracking.zstack.records import FeedbackRecord, SensingRecord

BEGUN, LINK = 1000.0, 0.05  # [s] of the clock; from where a robot is to where it is told to be
EXACT = CellsConfig(lasts=12.0, range_std=0.0)


def driven(air, rate=1.0, deaf=False):
    """Measure all requests; both robots are told where they were a little before."""
    told, measured = [], []
    for epoch in air.epochs:
        now = BEGUN + epoch.time_s / rate
        due = [t for t in told if t.time_s <= now]
        told = told[len(due) :]
        measured.append(air.measure(epoch, now, [] if deaf else due))
        at = air.samples[epoch.robot_id][-1][1]
        told.append(Told(now + LINK / rate, 0xFFFF, FeedbackRecord(epoch.robot_id, *at.tolist())))
    return measured


def states(air):
    return (np.array([state for _, state in air.samples[target]]) for target in (FIRST, SECOND))


@pytest.mark.parametrize('rate', [1.0, 4.0])
def test_a_robot_that_is_told_where_both_are_catches_up(rate):
    air = DrivenAir(DrivenConfig(cells=EXACT), 1, rate)
    driven(air, rate)
    first, second = states(air)
    error = phase_error(FollowConfig(), first[:, :2], second[:, :2])
    assert error[0] == pytest.approx(2.0)
    assert np.abs(error[-20:]).max() < np.radians(5.0)


def test_a_robot_that_is_told_nothing_stands():
    air = DrivenAir(DrivenConfig(cells=EXACT), 1)
    driven(air, deaf=True)
    first, second = states(air)
    assert np.ptp(second, axis=0).tolist() == [0.0] * 4
    assert np.array_equal(first, d_cells.d_phase(EXACT).truth)
    assert air.heard == 0


def test_ranges_are_to_where_the_robots_are():
    air = DrivenAir(DrivenConfig(cells=EXACT), 1)
    measured = driven(air)
    first, second = states(air)
    for epoch in measured[::7]:
        (reading,) = epoch.readings
        at = (first if epoch.robot_id == FIRST else second)[epoch.request_seq, :2]
        place = air.anchors.positions[reading.node_id - 1, :2]
        assert reading.range_m == pytest.approx(np.hypot(*(at - place)))


def test_a_lost_range_is_none_and_others_are_as_they_were():
    """Losses are drawn beside the noise: they shift nothing."""
    whole, thinned = (
        [e.readings for e in driven(DrivenAir(DrivenConfig(cells=CellsConfig(lasts=3.0, dropout=p)), 2), deaf=True)]
        for p in (0.0, 0.3)
    )
    lost = [not readings for readings in thinned]
    assert 0.15 < np.mean(lost) < 0.45
    early = [k for k in range(20) if thinned[k]]  # until the station has a position, nodes take turns
    assert [thinned[k] for k in early] == [whole[k] for k in early]


def test_what_is_told_of_others_and_of_sensing_moves_nothing():
    air = DrivenAir(DrivenConfig(cells=EXACT), 1)
    records = FeedbackRecord(7, 1.0, 1.0, 0.0, 0.0), SensingRecord(1, 1, -55, 0.2, 0.6)
    strange = [Told(BEGUN, 0, record) for record in records]
    for epoch in air.epochs[:40]:
        air.measure(epoch, BEGUN + epoch.time_s, strange)
    assert np.ptp(np.array([s for _, s in air.samples[SECOND]]), axis=0).tolist() == [0.0] * 4


def test_without_a_clock_nothing_is_driven():
    with pytest.raises(TrackingError, match='expected a `rate` above 0'):
        DrivenAir(DrivenConfig(), 1, 0.0)


# ---- what a bag tells of it


START, STEP = 1_700_000_000_000_000_000, 50_000_000


def estimate(target, stamp, x, y, kind=Kind.LOCAL):
    mean = np.array([x, y, 0.0, 0.0])
    name = f'hybrid_target_{target}'
    return Estimate(stamp, target, 0, name, mean, np.eye(4), (), (), kind=kind, state_names=PLANAR_STATES)


def recorded(path, *, seen=True):
    """Both robots go round in phase; the second is seen a metre too far east, from the third instant on."""
    angle = 0.03 * np.arange(6)
    with BagWriter(path, {'entry_level': 'range'}) as bag:
        bag.write('anchors', make_anchors([1, 2, 3], [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 6.0, 0.0]]), START)
        for k, a in enumerate(angle.tolist()):
            t = START + k * STEP
            c, s = np.cos(a), np.sin(a)
            for target, x, y in ((FIRST, 1.0 + 0.5 * c, 5.0 + 0.5 * s), (SECOND, 2.0 + c, 2.0 + s)):
                bag.write(f'truth/target_{target}', TruthPose(t, target, (x, y, 0.0), (-s, c, 0.0)), t)
                bag.write('request', Request(t, target, k), t)
                bag.write('epoch_end', EpochEnd(t, target, k, 'range', (), (), k == 5), t)
                if seen:
                    kind = Kind.LOCAL if k >= 2 else Kind.START
                    bag.write(f'estimate/hybrid_target_{target}', estimate(target, t, x + target - 1, y, kind), t)
    return path


def test_a_recorded_run_is_what_was_recorded(tmp_path):
    run = phase_run(recorded(tmp_path / 'bag'), FollowConfig())
    assert run.times == pytest.approx(0.05 * np.arange(6))
    assert run.error == pytest.approx(np.zeros(6), abs=1e-12)
    assert np.isnan(run.estimates[:, :2]).all()
    offset = run.estimates[:, 2:] - run.truth[:, 2:, :2]
    assert offset[0] == pytest.approx(np.zeros((4, 2)))
    assert offset[1] == pytest.approx(np.tile([1.0, 0.0], (4, 1)))
    assert np.hypot(*run.truth[1, :, 2:].T) == pytest.approx(np.ones(6))


def test_a_bag_of_something_else_is_refused(tmp_path):
    with pytest.raises(TrackingError, match=r'holds the truth of targets \[1, 2\] and estimates \[\]: expected both'):
        phase_run(recorded(tmp_path / 'bag', seen=False), FollowConfig())

"""What the tracker of a person says of him: estimates, state, particles and reports."""

import math
from dataclasses import replace

import numpy as np
import pytest
from human_cases import ANCHORS, EPOCHS, FEW, PROFILE, SECOND, TRUTH, epochs, run

from wsn_tracking.simulation.c_body import BodyConfig, nodes
from wsn_tracking.simulation.record import TARGET
from wsn_tracking.trackers.estimate import Kind, check_usable
from wsn_tracking.trackers.human import HumanTracker
from wsn_tracking.trackers.human_config import ResamplingConfig, StartConfig


@PROFILE
def test_every_profile_follows_a_walk(profile):
    """Better than who knows nothing and says the middle of the area; by half, but for the documents' weaker forms."""
    tracker = HumanTracker(replace(FEW, profile=profile), ANCHORS)
    found = np.array([e[0].mean[:2] for e in run(tracker)])
    told, guessed = (np.linalg.norm(place - TRUTH[:, :2], axis=-1)[20:] for place in (found, [50.0, 50.0]))
    share = 1.0 if profile in {'rss_mcl', 'paper_direction'} else 0.5
    assert np.mean(told**2) < share**2 * np.mean(guessed**2)


def test_an_estimate_names_its_source_its_time_its_epoch_and_its_nodes():
    tracker = HumanTracker(replace(FEW, lag=3.0), ANCHORS)
    assert tracker.outputs == ('human', 'human_lag')
    assert HumanTracker(FEW, ANCHORS).outputs == ('human',)
    for k, (now, then) in enumerate(run(tracker)):
        assert (now.source, then.source) == tracker.outputs
        assert (now.stamp_ns, then.stamp_ns) == (EPOCHS[k].stamp_ns, EPOCHS[k].stamp_ns - 3 * SECOND)
        assert now.request_seq == then.request_seq == k
        assert now.measurements == tuple(p.node_id for p in EPOCHS[k].measurements)
        assert (now.kind, then.kind) == (Kind.LOCAL, Kind.SMOOTHED if k >= 6 else Kind.START)
        for estimate in (now, then):
            check_usable(estimate)


def test_the_lagged_estimate_is_of_the_time_it_says():
    """At the same instants it is better than what was said then; told of the wrong instant it would be worse."""
    tracker = HumanTracker(replace(FEW, particles=1000, lag=3.0), ANCHORS)
    sequence, truth = epochs(BodyConfig(duration=120.0), 3)
    out = run(tracker, sequence)
    filtered = np.array([e[0].mean[:2] for e in out])[20:-6]
    lagged = np.array([e[1].mean[:2] for e in out])[26:]
    where = truth[20:-6, :2]
    errors = [np.sqrt(np.mean(np.sum((m - where) ** 2, axis=-1))) for m in (filtered, lagged)]
    assert errors[1] < 0.95 * errors[0]


def test_the_lagged_estimate_admits_what_it_does_not_know_where_its_paths_have_died_out():
    """In a small room the particles of 3 s ago have one or two descendants, whose scatter is no error."""
    config = BodyConfig(width=10.0, depth=8.0, duration=60.0)
    anchors = nodes(config)
    sequence, truth = epochs(config, 3)
    out = run(HumanTracker(replace(FEW, particles=300, lag=3.0), anchors), sequence)
    where = truth[20:-6, :2]
    nees = []
    for told in ([e[0] for e in out][20:-6], [e[1] for e in out][26:]):
        e, P = np.array([m.mean[:2] for m in told]) - where, np.array([m.covariance[:2, :2] for m in told])
        nees.append(np.mean(np.einsum('ki,kij,kj->k', e, np.linalg.inv(P), e)))
    assert nees[1] < 2.0 * nees[0]


def test_kind_is_start_until_somebody_is_heard():
    tracker = HumanTracker(FEW, ANCHORS)
    silent = [e._replace(measurements=()) for e in EPOCHS[:5]]
    assert [e[0].kind for e in run(tracker, silent)] == [Kind.START] * 5
    assert tracker.step(EPOCHS[5])[0].kind == Kind.LOCAL
    assert tracker.step(EPOCHS[6]._replace(measurements=()))[0].kind == Kind.LOCAL


def test_state_tells_what_the_estimate_does_not():
    tracker = HumanTracker(FEW, ANCHORS)
    assert tracker.state()['n_eff'] == 200.0
    assert tracker.particles.positions.shape == (200, 2)
    (estimate,) = run(tracker)[-1]
    state = tracker.state()
    heard = {p.node_id for p in EPOCHS[-1].measurements}
    assert {node for node, value in state['evidence'].items() if value != 0.0} == heard
    assert 1.0 <= state['n_eff'] <= state['particles'] == 200
    assert -math.pi <= state['heading'] <= math.pi
    assert 0.0 <= state['heading_known'] <= 1.0
    assert state['speed'] <= 2.0
    assert state['reset'] is False
    positions, facing, weights = tracker.particles
    assert facing.shape == (200,)
    assert weights.sum() == pytest.approx(1.0)
    np.testing.assert_allclose(weights @ positions, estimate.mean[:2], rtol=1e-12)
    tracker.step(EPOCHS[-1]._replace(measurements=EPOCHS[-1].measurements[:1]))
    state = tracker.state()
    assert [state['log_evidence']] == pytest.approx(list(state['evidence'].values()))  # of one node that of the epoch


def test_equal_particles_are_those_of_the_estimate():
    """As a systematic sample: within a particle's share of each weight, so that the mean is nearly that of all."""
    tracker = HumanTracker(replace(FEW, particles=1000), ANCHORS)
    run(tracker, EPOCHS[:10])
    (estimate,) = tracker.step(EPOCHS[10])
    positions, facing, weights = tracker.equal_particles()
    assert len(facing) == 1000
    np.testing.assert_array_equal(weights, 1e-3)
    spread = np.sqrt(np.diag(estimate.covariance)[:2])
    np.testing.assert_allclose(positions.mean(axis=0), estimate.mean[:2], atol=0.1 * spread.max())


def test_particles_grow_fewer_once_he_is_found():
    config = replace(
        FEW, profile='paper_max', particles=2000, resampling=ResamplingConfig(kld=0.1, kld_cell=2.0, kld_least=60)
    )
    tracker = HumanTracker(replace(config, lag=2.0), ANCHORS)
    out = run(tracker)
    assert 60 <= tracker.state()['particles'] < 1000
    for now, then in out:
        check_usable(now)
        check_usable(then)


def test_a_report_tells_what_the_epoch_said():
    tracker = HumanTracker(replace(FEW, start=StartConfig(draws=1000, reset_epochs=0)), ANCHORS)
    assert tracker.report() is None
    run(tracker, EPOCHS[:5])
    report = tracker.report()
    assert (report.stamp_ns, report.target_id, report.request_seq) == (EPOCHS[4].stamp_ns, TARGET, 4)
    assert report.node_ids == tuple(sorted(p.node_id for p in EPOCHS[4].measurements))
    assert len(report.node_log_evidences) == len(report.node_ids)
    assert (report.reset, report.resets) == (False, 0)
    other = HumanTracker(FEW, ANCHORS)  # the same evidence, computed for its resets
    run(other, EPOCHS[:5])
    np.testing.assert_allclose(other.report().node_log_evidences, report.node_log_evidences)

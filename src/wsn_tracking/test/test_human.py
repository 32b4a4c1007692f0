"""System C's tracker: what it makes of profiles, epochs, silence, nonsense, ranges, the past and the borders."""

import math
from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles import properties

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.models.body import LOS, NLOS, SINGLE
from wsn_tracking.models.body_likelihood import Readings
from wsn_tracking.models.draws import keyed
from wsn_tracking.models.radio_map import make_map
from wsn_tracking.models.walk import PSI, STATES, WALKING, X, Y
from wsn_tracking.parameters import build, specs
from wsn_tracking.sensing.channel import Channel, PathLoss, Quantity, save_channel
from wsn_tracking.sensing.values import NAN, Epoch, Modality, Range, RangeBearing, Rssi
from wsn_tracking.simulation.c_body import BodyConfig, body_scenario, nodes
from wsn_tracking.simulation.record import START_NS, TARGET, record
from wsn_tracking.trackers.estimate import Kind, check_usable
from wsn_tracking.trackers.human import HUMAN, HumanTracker
from wsn_tracking.trackers.human_config import (
    PROFILES,
    HumanConfig,
    MotionConfig,
    ResamplingConfig,
    SignalConfig,
    StartConfig,
)
from wsn_tracking.trackers.human_filter import HumanFilter
from wsn_tracking.trackers.human_models import curves_of
from wsn_tracking.trackers.human_readings import SignalTable

SECOND = 1_000_000_000
AREA = (0.0, 0.0, 100.0, 100.0)
ANCHORS = nodes(BodyConfig())
FEW = HumanConfig(particles=200, area=AREA, start=StartConfig(draws=1000))
PROFILE = pytest.mark.parametrize('profile', sorted(PROFILES))


def epochs(config=None, seed=1):
    """The epochs of a short c_walk, and where he was."""
    scenario = body_scenario('c_walk', config or BodyConfig(duration=20.0), seed)
    by_epoch = {k: [] for k in range(len(scenario.truth))}
    for m in record(scenario, seed).messages:
        if isinstance(m, Rssi):
            by_epoch[m.request_seq].append(m)
    stamps = [START_NS + round(k * scenario.period * SECOND) for k in by_epoch]
    return [Epoch(TARGET, k, t, tuple(by_epoch[k])) for k, t in zip(by_epoch, stamps, strict=True)], scenario.truth


EPOCHS, TRUTH = epochs()


def run(tracker, sequence=EPOCHS):
    return [tracker.step(epoch) for epoch in sequence]


def same(one, other):
    for a, b in zip(one, other, strict=True):
        for x, y in zip(a, b, strict=True):
            np.testing.assert_array_equal(x.mean, y.mean)
            np.testing.assert_array_equal(x.covariance, y.covariance)


# --- configuration


@PROFILE
def test_a_profile_is_what_single_parameters_do_not_say(profile):
    config = HumanConfig(profile=profile)
    chosen = PROFILES[profile]
    assert (config.motion_kind, config.kernel.kind) == (chosen['motion'], chosen['signal'])
    assert (config.v_max, config.extra_db, config.kernel.outlier) == (
        chosen['v_max'],
        chosen['extra'],
        chosen['outlier'],
    )
    assert (config.draws, config.reset_epochs) == (chosen['draws'], chosen['reset'])
    told = build(
        HumanConfig,
        {
            'profile': profile,
            'motion.kind': 'random_walk',
            'motion.v_max': 1.5,
            'signal.kind': 'single',
            'signal.extra': 0.0,
            'signal.outlier': 0.0,
            'start.draws': 0,
            'start.reset_epochs': 0,
        },
    )
    assert (told.motion_kind, told.kernel.kind, told.v_max) == ('random_walk', 'single', 1.5)
    assert (told.extra_db, told.kernel.outlier, told.draws, told.reset_epochs) == (0.0, 0.0, 0, 0)


def test_profiles_are_the_documents():
    baseline = HumanConfig(profile='rss_mcl')
    assert (baseline.kernel.kind, baseline.motion_kind, baseline.extra_db) == ('single', 'disc', 5.6)
    assert HumanConfig(profile='paper_max').v_max == 4.0
    assert HumanConfig().profile == 'improved'
    assert HumanConfig().particles == 500


def test_every_parameter_is_described_and_its_default_is_accepted():
    for spec in specs(HumanConfig):
        assert spec.why
    assert build(HumanConfig, {spec.name: spec.default for spec in specs(HumanConfig)}) == HumanConfig()


@pytest.mark.parametrize(
    ('config', 'words'),
    [
        (HumanConfig(area=(0.0, 0.0, -1.0, 1.0)), 'expected x_min'),
        (HumanConfig(area=(0.0, 0.0)), 'expected x_min'),
        (HumanConfig(signal=SignalConfig(los=(1.0,))), 'signal.los'),
        (HumanConfig(motion=MotionConfig(slowest=3.0)), 'motion.fastest'),
        (HumanConfig(resampling=ResamplingConfig(kld_least=10, kld_most=5)), 'kld_most'),
    ],
)
def test_contradictions_are_refused(config, words):
    with pytest.raises(TrackingError, match=words):
        HumanTracker(config, ANCHORS)


def test_given_curves_are_for_every_node_and_loss_is_of_all():
    anchors = make_anchors([1, 2], [[0.0, 0.0], [5.0, 0.0]], p1_dbm=[-40.0, -60.0], n=2.0)
    given_ = curves_of(HumanConfig(signal=SignalConfig(curves='given', body_loss=-6.5)), anchors)
    for curve, base in zip(given_, (LOS, NLOS, SINGLE), strict=True):
        np.testing.assert_array_equal(curve.p_ref, np.full(2, base.p_ref - 6.5))
        np.testing.assert_array_equal(curve.k, np.full(2, base.k))
    own = curves_of(HumanConfig(signal=SignalConfig(body_loss=-6.5)), anchors)
    np.testing.assert_allclose(own.single.p_ref, [-46.5, -66.5])


# --- outputs


@PROFILE
def test_every_profile_follows_a_walk(profile):
    """Within reach of its own error on this scenario; the baseline's is some 9 m."""
    tracker = HumanTracker(replace(FEW, profile=profile), ANCHORS)
    error = np.array([e[0].mean[:2] for e in run(tracker)])[20:] - TRUTH[20:, :2]
    assert np.sqrt(np.mean(np.sum(error**2, axis=-1))) < (30.0 if profile in ('rss_mcl', 'paper_direction') else 6.0)


def test_what_an_estimate_says():
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
    run(tracker)
    state = tracker.state()
    heard = {p.node_id for p in EPOCHS[-1].measurements}
    assert {node for node, value in state['evidence'].items() if value != 0.0} == heard
    assert state['log_evidence'] == pytest.approx(sum(state['evidence'].values()), abs=0.2 * len(heard) + 3.0)
    assert 1.0 <= state['n_eff'] <= state['particles'] == 200
    assert -math.pi <= state['heading'] <= math.pi
    assert 0.0 <= state['heading_known'] <= 1.0
    assert state['speed'] <= 2.0
    assert state['reset'] is False
    positions, facing, weights = tracker.particles
    assert facing.shape == (200,)
    assert weights.sum() == pytest.approx(1.0)
    np.testing.assert_allclose(weights @ positions, tracker.step(EPOCHS[-1])[0].mean[:2], atol=3.0)


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


# --- repeatable


@PROFILE
def test_two_trackers_agree_bit_for_bit_and_so_does_one_that_begins_anew(profile):
    config = replace(FEW, profile=profile, lag=1.0)
    tracker = HumanTracker(config, ANCHORS)
    first = run(tracker)
    same(first, run(HumanTracker(config, ANCHORS)))
    tracker.reset()
    same(first, run(tracker))


def test_draws_belong_to_their_epoch():
    """A tracker that was asked for other things in between, or loses an epoch, draws what it would have drawn."""
    tracker, other = HumanTracker(FEW, ANCHORS), HumanTracker(FEW, ANCHORS)
    run(tracker, EPOCHS[:10])
    for epoch in EPOCHS[:10]:
        other.step(epoch)
        other.state()
    same([tracker.step(EPOCHS[10])], [other.step(EPOCHS[10])])
    assert tracker._draws.at(11).random() == keyed(FEW.seed, HUMAN, 11).random()
    reseeded = HumanTracker(replace(FEW, seed=1), ANCHORS)
    assert np.all(reseeded.particles.positions != HumanTracker(FEW, ANCHORS).particles.positions)


@PROFILE
def test_one_run_of_a_batch_is_a_run_alone(profile):
    config = replace(FEW, profile=profile)
    curves = curves_of(config, ANCHORS)
    alone, batch = (HumanFilter(config, ANCHORS, AREA) for _ in range(2))
    rngs = [np.random.default_rng(5) for _ in range(2)]
    a, b = alone.begin((), rngs[0]), batch.begin((1,), rngs[1])
    for epoch in EPOCHS[:12]:
        z = np.full(16, np.nan)
        z[[p.node_id - 1 for p in epoch.measurements]] = [p.rssi_dbm for p in epoch.measurements]
        sigma = np.full(16, 3.0)
        one = alone.step(a, 0.5, Readings(z, sigma, curves), rngs[0])
        many = batch.step(b, 0.5, Readings(z[None], sigma[None], curves), rngs[1])
        a, b = one.track, many.track
        np.testing.assert_allclose(many.mean[0], one.mean, rtol=1e-8, atol=1e-8)
        np.testing.assert_allclose(many.evidence[0], one.evidence, rtol=1e-8)


# --- against an exact filter


def test_it_is_the_grid_filter_of_its_model():
    """Random walk, two curves of which the likelier counts, on a corner of c_walk: a dense grid with 0.25 m cells."""
    config = HumanConfig(
        profile='paper_max',
        particles=20_000,
        area=(0.0, 0.0, 30.0, 30.0),
        motion=MotionConfig(kind='random_walk', step=1.0),
    )
    human, curves = HumanFilter(config, ANCHORS, (0.0, 0.0, 30.0, 30.0)), curves_of(config, ANCHORS)
    axis = np.arange(0.125, 30.0, 0.25)
    grid = np.stack(np.meshgrid(axis, axis, indexing='ij'))
    std = 1.0 * math.sqrt(0.5)
    kernel = np.exp(-0.5 * ((axis[:, None] - axis) / std) ** 2)
    kernel /= np.sqrt(2.0 * math.pi) * std / 0.25
    rng = np.random.default_rng(1)
    track, density = human.begin((), rng), np.full(grid.shape[1:], 1.0 / axis.size**2)
    place = np.array([14.0, 17.0])
    for k in range(8):
        if k:
            arrives = kernel @ density @ kernel.T
            stays = 1.0 - np.outer(kernel.sum(axis=0), kernel.sum(axis=0))  # who would leave stays where he was
            density = arrives + density * stays
        d = np.hypot(*(place[:, None] - ANCHORS.positions[:, :2].T))
        z = LOS.p_ref + LOS.k * np.log10(d) + 3.0 * rng.standard_normal(16)
        z[d > 50.0] = np.nan
        likelihood = np.zeros(density.shape)
        for i in np.flatnonzero(~np.isnan(z)):
            lg = np.log10(np.maximum(np.hypot(*(grid - ANCHORS.positions[i, :2, None, None])), 0.3))
            e = np.minimum(*(np.abs(z[i] - c.p_ref - c.k * lg) for c in (LOS, NLOS)))
            likelihood += -0.5 * (e / 3.0) ** 2 - math.log(3.0 * math.sqrt(2.0 * math.pi))
        density = density * np.exp(likelihood)
        evidence = density.sum()
        density /= evidence
        step = human.step(track, 0.5 if k else 0.0, Readings(z, np.full(16, 3.0), curves), rng)
        track = step.track
        mean = np.tensordot(grid, density, 2)
        spread = np.sqrt(np.tensordot((grid - mean[:, None, None]) ** 2, density, 2))
        # some 2000 particles count: a standard error of 0.02 deviations
        np.testing.assert_allclose(step.mean[:2], mean, atol=0.12 * spread.max())
        np.testing.assert_allclose(np.sqrt(np.diag(step.covariance)[:2]), spread, rtol=0.1)
        assert step.evidence == pytest.approx(math.log(evidence), abs=0.15)


# --- what must not break it


def packet(node, dbm, k=0, sigma=NAN):
    return Rssi(START_NS, node, TARGET, k, k, dbm, sigma)


def bounded(estimates, area=AREA):
    width, depth = area[2] - area[0], area[3] - area[1]
    for estimate in estimates:
        check_usable(estimate)
        assert area[0] - 1e-9 <= estimate.mean[0] <= area[2] + 1e-9
        assert area[1] - 1e-9 <= estimate.mean[1] <= area[3] + 1e-9
        assert np.trace(estimate.covariance[:2, :2]) <= 0.25 * (width**2 + depth**2) + 1e-3
        assert np.trace(estimate.covariance[2:, 2:]) < 100.0


NONSENSE = {
    'nothing': lambda k: (),
    'one_node': lambda k: (packet(6, -60.0),),
    'impossible': lambda k: (packet(1, 127.0), packet(2, -128.0), packet(3, NAN), packet(4, math.inf)),
    'at_the_limits': lambda k: tuple(packet(i, (-127.0, 20.0)[(i + k) % 2]) for i in range(1, 17)),
    'exact': lambda k: tuple(packet(i, -70.0 - k, sigma=1e-9) for i in range(1, 17)),
    'strangers': lambda k: (packet(99, -60.0), RangeBearing(START_NS, 1, TARGET, k, k, 3.0, 0.1, (1.0, 0.0, 0.0, 1.0))),
    'far_away': lambda k: tuple(packet(i, -120.0) for i in range(1, 17)),
    'everywhere_at_once': lambda k: tuple(packet(i, -46.0) for i in range(1, 17)),
}


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
def test_nodes_at_one_place_or_on_one_line(profile, positions):
    anchors = make_anchors([1, 2, 3, 4], positions)
    tracker = HumanTracker(HumanConfig(profile=profile, particles=200, start=StartConfig(draws=500)), anchors)
    for k in range(8):
        packets = tuple(packet(i, -55.0 - i) for i in (1, 2, 3, 4))
        (estimate,) = tracker.step(Epoch(TARGET, k, START_NS + k * SECOND, packets))
        check_usable(estimate)
        assert np.hypot(*(estimate.mean[:2] - 3.0)) < 6.0


@PROFILE
@pytest.mark.parametrize('dt_ns', [0, -SECOND, 1, 40 * SECOND, 3600 * SECOND])
def test_any_step_of_time(profile, dt_ns):
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
def test_any_readings_at_any_time(seed, profile, dof, motion, kind):
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


# --- start and reset


def test_it_starts_where_the_first_epoch_says():
    """Mean and spread of the posterior of one epoch, places and directions even: on a grid of 1 m and 24 directions."""
    axis = np.arange(0.5, 100.0, 1.0)
    x, y, psi = (v.ravel() for v in np.meshgrid(axis, axis, math.pi * np.arange(24) / 12.0))
    s = np.zeros((STATES, x.size))
    s[X], s[Y], s[PSI] = x, y, psi
    for seed in range(3):
        sequence, _ = epochs(BodyConfig(duration=1.0), seed)
        config = replace(FEW, particles=5000, start=StartConfig(draws=40_000))
        tracker = HumanTracker(config, ANCHORS)
        (estimate,) = tracker.step(sequence[0])
        readings, _ = tracker._table.read(sequence[0])
        l = tracker._filter.score(s, readings).l
        w = np.exp(l - l.max())
        w /= w.sum()
        mean = np.array([w @ x, w @ y])
        spread = np.sqrt([w @ (x - mean[0]) ** 2, w @ (y - mean[1]) ** 2])
        np.testing.assert_allclose(estimate.mean[:2], mean, atol=0.15 * spread.max())  # some 500 draws count
        np.testing.assert_allclose(np.sqrt(np.diag(estimate.covariance)[:2]), spread, rtol=0.15)


@pytest.mark.parametrize('offsets', [False, True])
def test_after_a_long_silence_places_are_weighed_about_where_he_may_have_gone(offsets):
    """Twenty seconds of silence: what one node says then leaves places behind that the walk could not have reached."""
    signal = SignalConfig(kind='single', outlier=0.0, offset_std=2.0) if offsets else SignalConfig()
    start = StartConfig(draws=5000, reset_epochs=0)
    tracker = HumanTracker(replace(FEW, particles=500, signal=signal, start=start), ANCHORS)
    run(tracker, EPOCHS[:12])
    was = tracker._last.mean[:2]
    stamp = EPOCHS[11].stamp_ns
    for k in range(12, 53):
        stamp += SECOND // 2
        tracker.step(Epoch(TARGET, k, stamp, ()))
    spread = np.sqrt(np.trace(tracker._last.covariance[:2, :2]))
    assert np.unique(tracker.particles.positions, axis=0).shape[0] <= 500
    (estimate,) = tracker.step(Epoch(TARGET, 53, stamp + SECOND // 2, (packet(6, -70.0, 53),)))
    assert tracker.counters['reset'] == 1
    assert np.unique(tracker.particles.positions, axis=0).shape[0] > 300  # places of their own, not copies of a few
    far = np.hypot(*(tracker.particles.positions - was).T) > 4.0 * spread
    assert far.mean() < 0.35  # a fifth of the places are anywhere, and weigh as much as one epoch says
    bounded([estimate])
    never = HumanTracker(replace(FEW, start=replace(start, silence=0.0)), ANCHORS)
    run(
        never,
        [
            *EPOCHS[:12],
            Epoch(TARGET, 12, EPOCHS[11].stamp_ns + 50 * SECOND, ()),
            EPOCHS[13]._replace(stamp_ns=EPOCHS[11].stamp_ns + 51 * SECOND),
        ],
    )
    assert never.counters['reset'] == 0


def test_a_target_that_is_elsewhere_is_found_again_and_counted():
    config = BodyConfig(duration=60.0, teleport_at=30.0)
    sequence, truth = epochs(config, 2)
    tracker = HumanTracker(replace(FEW, particles=500, lag=1.0), ANCHORS)
    out = run(tracker, sequence)
    assert tracker.counters['reset'] >= 1
    assert np.hypot(*(out[-1][0].mean[:2] - truth[-1, :2])) < 8.0
    never = HumanTracker(replace(FEW, particles=500, start=StartConfig(reset_epochs=0)), ANCHORS)
    run(never, sequence)
    assert never.counters['reset'] == 0


WITH_A_YARD = """x,y
0,0
100,0
100,100
0,100

40,40
60,40
60,60
40,60
"""


def test_a_floor_plan_is_kept_to_from_the_first_particle_on(tmp_path):
    """A house of 100 x 100 m round a yard, inside an area of half its width."""
    plan = tmp_path / 'layout.csv'
    plan.write_text(WITH_A_YARD)
    config = replace(FEW, area=(0.0, 0.0, 50.0, 200.0), floor_plan=str(plan))
    tracker = HumanTracker(config, ANCHORS)
    assert tracker._filter.area == (0.0, 0.0, 50.0, 100.0)
    for epoch in [None, *EPOCHS]:
        if epoch is not None:
            bounded(tracker.step(epoch))
        x, y = tracker.particles.positions.T
        assert (x <= 50.0).all()
        assert not ((x > 40.0) & (y > 40.0) & (y < 60.0)).any()


@pytest.mark.parametrize('kind', ['walk', 'random_walk', 'disc'])
def test_nobody_walks_through_a_wall(tmp_path, kind):
    """Two rooms with a wall of 10 cm between them: who is in one stays there, however long nothing is heard."""
    plan = tmp_path / 'rooms.csv'
    plan.write_text('0,0\n4.9,0\n4.9,10\n0,10\n\n5,0\n10,0\n10,10\n5,10\n')
    config = replace(FEW, area=(), floor_plan=str(plan), motion=MotionConfig(kind=kind), particles=400)
    human = HumanTracker(config, ANCHORS)._filter
    rng = np.random.default_rng(1)
    track = human.begin((), rng)
    left = track.cloud.s[X] < 4.95
    assert 100 < left.sum() < 300
    silent = Readings(np.full(16, np.nan), np.full(16, 3.0), curves_of(config, ANCHORS))
    for dt in (0.5, 0.5, 3.0, 30.0):
        track = human.step(track, dt, silent, rng).track
        assert track.parents is None
        np.testing.assert_array_equal(track.cloud.s[X] < 4.95, left)


def test_a_corner_polygon_is_an_area_too():
    tracker = HumanTracker(replace(FEW, area=(0.0, 0.0, 100.0, 0.0, 0.0, 100.0)), ANCHORS)
    run(tracker)
    assert (tracker.particles.positions.sum(axis=-1) <= 100.0 + 1e-9).all()


def test_a_plan_that_cannot_be_read_is_refused(tmp_path):
    with pytest.raises(TrackingError, match=r'no\.csv cannot be read'):
        HumanTracker(replace(FEW, floor_plan=str(tmp_path / 'no.csv')), ANCHORS)


# --- radios and maps


def shifted(by):
    """The epochs, with node i read by[i] too much."""
    return [
        e._replace(measurements=tuple(p._replace(rssi_dbm=p.rssi_dbm + by[p.node_id - 1]) for p in e.measurements))
        for e in EPOCHS
    ]


def test_radios_and_their_map_come_from_a_channel_file(tmp_path):
    """Path loss 12 dB higher and a field of +8 dB everywhere: readings 20 dB louder say what the others said."""
    points = np.stack(np.meshgrid(np.arange(-10.0, 120.0, 10.0), np.arange(-10.0, 120.0, 10.0)), axis=-1).reshape(-1, 2)
    p1, n = np.full(16, SINGLE.p_ref + 12.0), np.full(16, -SINGLE.k / 10.0)
    field = np.full((len(points), 16), 8.0)
    radio_map = make_map(ANCHORS.ids, p1, n, points, field, 0.01, 30.0, 100.0, 0.0, 3.0)
    three = [Quantity(value, 0.1 + 0.0 * value, value - 0.2, value + 0.2) for value in (p1, n, np.full(16, 3.0))]
    loss = PathLoss(*three, np.ones(16, int), np.ones(16, int))
    save_channel(tmp_path / 'with_map.yaml', Channel(ANCHORS.ids, loss, None, radio_map, {}))
    save_channel(tmp_path / 'without.yaml', Channel(ANCHORS.ids, loss, None, None, {}))
    config = replace(FEW, signal=SignalConfig(sigma=3.0))
    plain = HumanTracker(config, ANCHORS)
    s = plain._track.cloud.s
    for name, louder in (('with_map', 20.0), ('without', 12.0)):
        tracker = HumanTracker(replace(config, channel=str(tmp_path / f'{name}.yaml')), ANCHORS)
        for epoch, other in zip(EPOCHS, shifted(np.full(16, louder)), strict=True):
            said, same_again = (
                t._filter.score(s, t._table.read(e)[0]).l for t, e in ((tracker, other), (plain, epoch))
            )
            # the file has six digits, the field a noise of 0.01 dB: 1e-3 of what a residual of 60 dB weighs
            np.testing.assert_allclose(said - said.max(), same_again - same_again.max(), rtol=2e-3, atol=0.05)
    with_map = HumanTracker(replace(FEW, channel=str(tmp_path / 'with_map.yaml')), ANCHORS)
    assert with_map.anchors.sigma_db == pytest.approx(np.full(16, 3.0))


OFFSETS = SignalConfig(kind='single', outlier=0.0, offset_std=6.0, offset_time=1e5)


def test_offsets_of_links_are_learnt():
    """Links that read up to 9 dB wrong all the time: told of such links, the filter finds them out."""
    wrong = 9.0 * np.cos(np.arange(16.0) * 2.4)
    sequence, truth = [], epochs(BodyConfig(duration=120.0), 3)[1]
    rng = np.random.default_rng(2)
    for k, place in enumerate(truth):
        d = np.maximum(np.hypot(*(ANCHORS.positions[:, :2] - place[:2]).T), 0.3)
        z = SINGLE.p_ref + SINGLE.k * np.log10(d) + wrong + 2.0 * rng.standard_normal(16)
        packets = tuple(packet(i + 1, z[i], k, 2.0) for i in range(16))
        sequence.append(Epoch(TARGET, k, START_NS + k * SECOND // 2, packets))
    rmse = {}
    for name, signal in {'offsets': OFFSETS, 'none': replace(OFFSETS, offset_std=0.0)}.items():
        tracker = HumanTracker(replace(FEW, particles=1000, signal=signal), ANCHORS)
        error = np.array([e[0].mean[:2] for e in run(tracker, sequence)])[-120:] - truth[-120:, :2]
        rmse[name] = np.sqrt(np.mean(np.sum(error**2, axis=-1)))
        if name == 'offsets':
            b = tracker._track.cloud.s[STATES:].mean(axis=-1)
            assert np.std(b - wrong) < 0.3 * np.std(wrong)
    assert rmse['offsets'] < 0.5 * rmse['none']


def test_offsets_that_are_exactly_known_change_nothing():
    """Standard deviation 1e-9 dB: the filter without offsets."""
    with_, without = (replace(FEW, signal=replace(OFFSETS, offset_std=std)) for std in (1e-9, 0.0))
    for (a,), (b,) in zip(run(HumanTracker(with_, ANCHORS)), run(HumanTracker(without, ANCHORS)), strict=True):
        np.testing.assert_allclose(a.mean, b.mean, rtol=1e-6, atol=1e-6)


def test_offsets_are_for_one_curve():
    with pytest.raises(TrackingError, match=r'offset_std.*single'):
        HumanTracker(replace(FEW, signal=SignalConfig(offset_std=2.0)), ANCHORS)


@pytest.mark.parametrize('kind', sorted(NONSENSE))
def test_nonsense_leaves_offsets_bounded(kind):
    signal = replace(OFFSETS, offset_std=2.5, offset_time=5.0, dof=4.0)
    tracker = HumanTracker(replace(FEW, signal=signal, lag=1.0), ANCHORS)
    run(tracker, EPOCHS[:3])
    for k in range(6):
        bounded(tracker.step(Epoch(TARGET, 3 + k, EPOCHS[3 + k].stamp_ns, NONSENSE[kind](k))))
        assert np.isfinite(tracker._track.cloud.s).all()
        assert ((tracker._track.V >= 0.0) & (tracker._track.V <= 2.5**2 + 1e-9)).all()


# --- how many particles


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


# --- ranges


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
    assert np.sqrt(np.mean(np.square(errors[5:]))) < 2.0


def test_deviations_are_the_packets_else_the_nodes_unless_they_are_set():
    def sigma(config):
        table = SignalTable(config, ANCHORS, HumanTracker(FEW, ANCHORS).counters)
        return table.read(Epoch(TARGET, 0, START_NS, (packet(1, -60.0, sigma=4.0), packet(2, -60.0))))[0].sigma[:2]

    np.testing.assert_allclose(sigma(HumanConfig()), [4.0, 3.0])
    np.testing.assert_allclose(sigma(HumanConfig(signal=SignalConfig(sigma=5.0))), [5.0, 5.0])
    np.testing.assert_allclose(sigma(HumanConfig(profile='rss_mcl')), np.hypot([4.0, 3.0], 5.6))


def test_walkers_of_profiles_without_legs_always_walk():
    for profile in ('paper_max', 'rss_mcl'):
        config = replace(FEW, profile=profile)
        s = HumanFilter(config, ANCHORS, AREA).begin((3,), np.random.default_rng(1)).cloud.s
        assert s[:, WALKING].all()
        assert s[:, [X, Y]].max() > 90.0
        assert s[:, PSI].max() > 6.0


def test_groups_of_the_configuration_are_frozen():
    for field in fields(HumanConfig):
        assert field.name
    with pytest.raises(AttributeError):
        HumanConfig().particles = 3

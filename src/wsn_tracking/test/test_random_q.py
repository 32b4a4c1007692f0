"""Local estimators and their fusion as a node runs them: one epoch after the other."""

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import LOOP, NOISE, H, dense_ckf, dense_predict, properties, seeds

from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation.monte_carlo import repeated, sense, start_near, track
from wsn_tracking.filters.srckf import update
from wsn_tracking.fusion import covariance_intersection as ci
from wsn_tracking.models.measurement import constant_noise, log_range_function
from wsn_tracking.models.motion import constant_velocity
from wsn_tracking.models.noise import scaled_identity, white_acceleration
from wsn_tracking.models.radio import rssi_at
from wsn_tracking.sensing import trigger
from wsn_tracking.sensing.values import Epoch, Modality, Range, RangeBearing, Rssi
from wsn_tracking.trackers.estimate import Estimate, Kind, check_usable
from wsn_tracking.trackers.estimator import EstimatorConfig, make_estimator
from wsn_tracking.trackers.fusing import Fuser, FusionConfig, compared
from wsn_tracking.trackers.random_q import LocalEstimator, keep_inside, motion_of
from wsn_tracking.trackers.random_q_config import (
    NoiseConfig,
    RandomQConfig,
    ReacquireConfig,
    StartConfig,
    UpdateConfig,
)
from wsn_tracking.trackers.readings import MeasurementTable

IDS = LOOP.anchors.ids.tolist()
MEAN, STD = (0.65, 0.62, 0.06, 0.0), (0.1, 0.1, 0.06, 0.06)
GIVEN = RandomQConfig(start=StartConfig(kind='given', mean=MEAN, std=STD))


def epoch(k, z, **fields):
    """Ranges z (12,) [m] of RSSI, one second apart; NaN: not sent."""
    values = {'modality': Modality.RSSI, 'variance': math.nan, **fields}
    heard = [(i, float(r)) for i, r in zip(IDS, z, strict=True) if not np.isnan(r)]
    return Epoch(1, k, k * 10**9, tuple(Range(k * 10**9, i, 1, k, k, range=r, **values) for i, r in heard))


def epochs(seed=1, count=20):
    step = trigger.event(trigger.EventThresholds(alpha=LOOP.alpha))
    sensed = sense(LOOP, repeated(LOOP, 1), step, np.random.default_rng(seed))
    return [epoch(k, z) for k, z in enumerate(sensed.z[0, :count])]


def run(config, sequence, number=1):
    estimator = LocalEstimator(config, LOOP.anchors, number)
    return [estimator.step(e) for e in sequence]


def same(one, other):
    assert one._replace(mean=0, covariance=0, q=0) == other._replace(mean=0, covariance=0, q=0)
    np.testing.assert_array_equal(one.mean, other.mean)
    np.testing.assert_array_equal(one.covariance, other.covariance)
    np.testing.assert_array_equal(one.q, other.q)


# --- process noise


def test_identity_noise_is_q_times_one_and_nothing_passes_in_no_time():
    q = np.array([2.0, 7.0])
    np.testing.assert_array_equal(motion_of(NoiseConfig(), q, 1.0)[1], scaled_identity(q))
    F, chol_Q = motion_of(NoiseConfig(), q, 0.0)
    np.testing.assert_array_equal(F, np.eye(4))
    assert not chol_Q.any()
    assert chol_Q.shape == (2, 4, 4)


def test_acceleration_noise_is_scaled_on_its_root_by_2q_over_the_sum_of_the_bounds():
    config = NoiseConfig(kind='acceleration', q_min=2.0, q_max=6.0, spectral_density=0.3)
    whole = white_acceleration(0.3, 0.5)
    np.testing.assert_allclose(motion_of(config, np.array(4.0), 0.5)[1], whole)
    np.testing.assert_allclose(motion_of(config, np.array([2.0, 6.0]), 0.5)[1], [0.5 * whole, 1.5 * whole])


def test_a_velocity_that_is_forgotten_ends_where_it_began():
    """Long after the last reading a velocity has variance S time / 2, and no memory of what it was."""
    noise = NoiseConfig(kind='acceleration', spectral_density=0.25, velocity_time=2.0)
    F, chol_Q = motion_of(noise, np.array(7.0), 100.0)
    np.testing.assert_allclose(F[:, 2:], [[2.0, 0.0], [0.0, 2.0], [0.0, 0.0], [0.0, 0.0]], atol=1e-12)
    np.testing.assert_allclose((chol_Q @ chol_Q.T)[2:, 2:], 0.25 * np.eye(2), atol=1e-12)


def test_a_velocity_is_not_forgotten_without_white_acceleration():
    with pytest.raises(TrackingError, match='belongs to white acceleration'):
        RandomQConfig(noise=NoiseConfig(velocity_time=2.0)).checked()


def test_q_is_uniform_between_its_bounds_and_of_each_estimator_its_own():
    stats = pytest.importorskip('scipy.stats')
    config = dataclasses.replace(GIVEN, seed=9, noise=NoiseConfig(q_min=2.0, q_max=12.0))
    one, two = (np.array([LocalEstimator(config, LOOP.anchors, i).draw(k) for k in range(1000)]) for i in (1, 2))
    assert stats.kstest(one, 'uniform', (2.0, 10.0)).pvalue > 0.01
    assert abs(np.corrcoef(one, two)[0, 1]) < 0.12  # four standard deviations


def test_a_draw_depends_on_the_epoch_alone():
    """A restart, a lost epoch or a gap shifts nothing."""
    sequence = epochs()
    whole = run(GIVEN, sequence)
    late = run(GIVEN, sequence[7:])
    assert [e.q for e in late] == [e.q for e in whole[7:]]
    assert len({e.q for e in whole}) == len(whole)
    assert [e.q for e in run(dataclasses.replace(GIVEN, seed=1), sequence)] != [e.q for e in whole]


# --- one estimator


def test_an_estimator_is_algorithm_1():
    """Against the covariance form, with the estimator's own draws of q."""
    config = dataclasses.replace(GIVEN, update=UpdateConfig(r='measured'))
    m, P = np.array(MEAN), np.diag(np.square(STD))
    for k, (sent, estimate) in enumerate(zip(epochs(), run(config, epochs()), strict=True)):
        if k:
            m, P = dense_predict(m, P, constant_velocity(1.0), (0.01 * estimate.q) ** 2 * np.eye(4))
        rows = [i - 1 for i in estimate.measurements]
        z = np.array([p.range for p in sent.measurements])
        if rows:
            R = np.diag((1.56 * math.log(10.0) / 30.0 * z) ** 2)
            m, P = dense_ckf(m, P, z, lambda x, rows=rows: H(x)[..., rows], R)
        np.testing.assert_allclose(estimate.mean, m, atol=1e-10)
        np.testing.assert_allclose(estimate.covariance, P, atol=1e-10)
        assert estimate.contributors == (1,)
        assert estimate.kind == Kind.LOCAL
        assert (estimate.source, estimate.request_seq, estimate.stamp_ns) == ('local_1', k, k * 10**9)


def test_an_epoch_without_measurements_is_predicted_and_published():
    sequence = epochs()
    sequence[10] = sequence[10]._replace(measurements=())
    whole = run(GIVEN, sequence)
    before, after = whole[9], whole[10]
    np.testing.assert_allclose(after.mean, constant_velocity(1.0) @ before.mean, atol=1e-14)
    Q = (0.01 * after.q) ** 2 * np.eye(4)
    F = constant_velocity(1.0)
    np.testing.assert_allclose(after.covariance, F @ before.covariance @ F.T + Q, rtol=1e-10, atol=1e-15)
    assert after.measurements == ()
    assert GIVEN.noise.q_min <= after.q <= GIVEN.noise.q_max


def test_equal_epochs_give_equal_estimates_also_after_a_reset():
    estimator = LocalEstimator(GIVEN, LOOP.anchors, 1)
    first = [estimator.step(e) for e in epochs()]
    estimator.reset()
    for one, other in zip(first, [estimator.step(e) for e in epochs()], strict=True):
        same(one, other)


def test_the_step_is_as_long_as_the_stamps_say():
    sequence = epochs(count=6)
    config = dataclasses.replace(GIVEN, noise=NoiseConfig(kind='acceleration'))
    gap = [e._replace(stamp_ns=e.stamp_ns + 2 * 10**9 * (k > 3), measurements=()) for k, e in enumerate(sequence)]
    one, other = run(config, gap)[3:5]
    np.testing.assert_allclose(other.mean, constant_velocity(3.0) @ one.mean, atol=1e-14)
    backwards = [e._replace(stamp_ns=-e.stamp_ns, measurements=()) for e in sequence]
    for estimate in run(config, backwards):
        np.testing.assert_allclose(estimate.mean, MEAN)  # time that runs backwards does not pass


@pytest.mark.parametrize('passes', [1, 3])
def test_iplf_of_one_pass_is_ckf_and_of_three_is_another(passes):
    ckf = run(GIVEN, epochs())
    iplf = run(dataclasses.replace(GIVEN, update=UpdateConfig(kind='iplf', passes=passes)), epochs())
    assert all(np.array_equal(a.mean, b.mean) for a, b in zip(ckf, iplf, strict=True)) == (passes == 1)


def test_positions_are_kept_inside_an_area():
    area = (0.7, 0.65, 0.8, 0.7)
    for estimate in run(dataclasses.replace(GIVEN, area=area), epochs()):
        assert area[0] <= estimate.mean[0] <= area[2]
        assert area[1] <= estimate.mean[1] <= area[3]
    free = run(GIVEN, epochs())[3]
    from wsn_tracking.filters.belief import Belief

    belief = Belief(free.mean, np.linalg.cholesky(free.covariance))
    assert keep_inside(belief, ()) is belief
    np.testing.assert_array_equal(keep_inside(belief, area).chol_P, belief.chol_P)


def test_the_start_takes_the_first_epochs_that_hold_something():
    sequence = epochs(count=12)
    config = RandomQConfig(area=LOOP.area, start=StartConfig(epochs=3, speed=0.06))
    estimates = run(config, sequence)
    full = [k for k, e in enumerate(sequence) if e.measurements]
    assert [e.kind for e in estimates] == [Kind.START] * (full[2] + 1) + [Kind.LOCAL] * (11 - full[2])
    assert not sequence[0].measurements  # the event trigger is silent at first
    away = np.hypot(*(estimates[full[2]].mean[:2] - LOOP.truth[full[2], :2]))
    assert away < 3.0 * math.sqrt(np.trace(estimates[full[2]].covariance[:2, :2]))
    # neither truth nor the area's middle: another target's measurements lead there
    elsewhere = [epoch(k, H(np.array([[2.9, 2.0]]))[0]) for k in range(4)]
    np.testing.assert_allclose(run(config, elsewhere)[-1].mean[:2], [2.9, 2.0], atol=0.1)


def test_feedback_goes_on_from_the_fused_estimate():
    estimator = LocalEstimator(GIVEN, LOOP.anchors, 1)
    first = estimator.step(epochs()[0])
    fused = first._replace(mean=first.mean + 1.0, covariance=4.0 * first.covariance)
    estimator.feed_back(fused)
    after = estimator.step(epoch(1, np.full(12, np.nan)))
    np.testing.assert_allclose(after.mean, constant_velocity(1.0) @ fused.mean, rtol=1e-12)


# --- the batched study and the node


@pytest.mark.parametrize('options', [{}, {'r': 'measured'}, {'kind': 'iplf'}, {'kind': 'log', 'kappa': 1.0}])
def test_batched_runs_equal_the_estimator_run_by_run(options):
    update_config = UpdateConfig(**options)
    generator = np.random.default_rng(3)
    sensed = sense(LOOP, repeated(LOOP, 3)[:, :40], trigger.event(trigger.EventThresholds(alpha=0.3)), generator)
    start = start_near(sensed.states, generator)
    noise = NoiseConfig(q_min=2.0, q_max=12.0)
    u = generator.random((3, 2, 40))
    tracks = track(LOOP, sensed, start, RandomQConfig(noise=noise, update=update_config), u)
    for r, e in np.ndindex(3, 2):
        config = RandomQConfig(
            noise=noise, update=update_config, start=StartConfig(kind='given', mean=tuple(start.m[r]), std=STD)
        )
        estimator = LocalEstimator(config, LOOP.anchors, e)
        estimator.draw = lambda k, u=u[r, e]: 2.0 + 10.0 * u[k]
        for k in range(40):
            estimate = estimator.step(epoch(k, sensed.z[r, k]))
            np.testing.assert_allclose(tracks.m[r, e, k], estimate.mean, atol=1e-9)
            np.testing.assert_allclose(tracks.P[r, e, k], estimate.covariance, atol=1e-9)


# --- the measurement table

Z = H(LOOP.truth[5])
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
    from wsn_tracking.filters.belief import Belief

    belief = Belief(np.array(MEAN), np.diag(STD))
    for options in ({}, {'kind': 'log'}, {'r': 'measured'}):
        z, h, noise, ids = read([], **options)
        assert ids == ()
        np.testing.assert_array_equal(update(belief, z, h, noise, 2).m, belief.m)


# --- fusion


def locals_of(seed, count=3, k=0):
    rng = np.random.default_rng(seed)
    roots = rng.standard_normal((count, 4, 4)) * 0.05 + 0.1 * np.eye(4)
    return [
        Estimate(k, 1, k, f'local_{i}', rng.standard_normal(4), L @ L.T, (i,), (i, i + 3), 7.0)
        for i, L in enumerate(roots, start=1)
    ]


@properties
@given(seeds, st.sampled_from(['trace', 'optimal', 'lci', 'mean', 'ici']), st.permutations(range(3)))
def test_fusion_does_not_depend_on_neighbour_order(seed, rule, order):
    fused, shuffled = Fuser(FusionConfig(rule=rule), 'fused_1'), Fuser(FusionConfig(rule=rule), 'fused_1')
    for k in range(3):
        here = locals_of(seed + k, k=k)
        same(fused.step(here), shuffled.step([here[i] for i in order]))


@pytest.mark.parametrize('rule', ['trace', 'optimal', 'mean', 'ici'])
def test_a_fuser_says_what_it_used(rule):
    here, function = locals_of(3), getattr(ci, rule)
    fused = Fuser(FusionConfig(rule=rule), 'fused_2').step(here)
    m, P = np.stack([e.mean for e in here]), np.stack([e.covariance for e in here])
    np.testing.assert_array_equal(fused.mean, function(m, P).m)
    np.testing.assert_array_equal(fused.covariance, function(m, P).P)
    assert (fused.source, fused.contributors, fused.measurements) == ('fused_2', (1, 2, 3), (1, 2, 3, 4, 5, 6))
    assert fused.kind == Kind.FUSED
    assert math.isnan(fused.q)


def test_lci_starts_a_peer_anew_that_missed_an_epoch():
    config = FusionConfig(rule='lci')
    fuser = Fuser(config, 'fused_1')
    P0 = np.diag(np.square(config.lci_std))
    spread = dict.fromkeys((1, 2, 3), P0)
    for k, present in enumerate([(1, 2, 3), (1, 2, 3), (1, 3), (1, 2, 3)]):
        here = [e for e in locals_of(40 + k, k=k) if e.contributors[0] in present]
        before = {i: spread.get(i, P0) for i in present}
        m = np.stack([e.mean for e in here])
        d = m - m.mean(axis=0)
        floor = 1e-10 * np.eye(4)
        spread = {i: 0.5 * np.outer(v, v) + 0.5 * before[i] + floor for i, v in zip(present, d, strict=True)}
        fused = fuser.step(here)
        expected = ci.lci(m, np.stack([spread[i] for i in present]))
        np.testing.assert_allclose(fused.mean, expected.m, rtol=1e-9, atol=1e-12)
        assert np.isnan(fused.covariance).all()
        assert fused.contributors == present
    fuser.reset()
    again = locals_of(40)
    same(fuser.step(again), Fuser(config, 'fused_1').step(again))


def test_a_fused_position_is_kept_inside_too():
    fused = Fuser(FusionConfig(), 'fused_1', (5.0, 6.0, 7.0, 8.0)).step(locals_of(1))
    assert fused.mean[:2].tolist() == [5.0, 6.0]


def test_a_fused_start_is_a_start():
    starts = [e._replace(kind=Kind.START) for e in locals_of(2)]
    assert Fuser(FusionConfig(), 'f').step(starts).kind == Kind.START
    assert Fuser(FusionConfig(), 'f').step([*starts[:2], locals_of(2)[2]]).kind == Kind.FUSED


def test_every_run_is_compared_with_the_mean_and_lci():
    mean, lci = compared(FusionConfig(rule='optimal', feedback=True))
    assert (mean.config.rule, lci.config.rule) == ('mean', 'lci')
    assert (mean.source, lci.source) == ('mean', 'lci')


# --- refused


@pytest.mark.parametrize(
    ('config', 'message'),
    [
        (RandomQConfig(noise=NoiseConfig(q_min=3.0, q_max=2.0)), '`noise.q_max` 2 is below `noise.q_min` 3'),
        (RandomQConfig(noise=NoiseConfig(q_min=0.0, q_max=0.0)), '`noise.q_max` is 0'),
        (RandomQConfig(area=(0.0, 0.0, 1.0)), '`area` is'),
        (RandomQConfig(area=(0.0, 2.0, 1.0, 1.0)), 'expected x_min, y_min, x_max, y_max'),
        (RandomQConfig(start=StartConfig(mean=(1.0, 2.0))), 'four numbers each'),
        (RandomQConfig(reacquire=ReacquireConfig(rejects=3)), 'set `robust.gate` as well'),
        (EstimatorConfig(peers=(1, 2, 2)), 'names an estimator twice'),
        (FusionConfig(rule='lci', feedback=True), 'feedback` needs a fused covariance'),
        (FusionConfig(lci_std=(1.0,)), '`fusion.lci_std` takes four numbers'),
    ],
)
def test_configurations_that_contradict_themselves_are_refused(config, message):
    with pytest.raises(TrackingError, match=message):
        config.checked()


def test_an_estimator_hears_its_own_nodes_and_fuses_its_peers():
    config = EstimatorConfig(id=2, peers=(1, 3), nodes=(5, 1), start=GIVEN.start)
    local, fuser = make_estimator(config, LOOP.anchors)
    assert config.all_peers == (1, 2, 3)
    estimate = local.step(epoch(0, Z))
    assert estimate.measurements == (1, 5)
    assert estimate.source == 'local_2'
    assert fuser.source == 'fused_2'
    everyone, _ = make_estimator(dataclasses.replace(config, nodes=()), LOOP.anchors)
    assert everyone.step(epoch(0, Z)).measurements == tuple(IDS)


def test_only_estimates_that_can_be_fused_are_let_in():
    good = locals_of(1)[0]
    assert check_usable(good) is good
    P = good.covariance
    for field, message in [
        ({'state_names': ('x', 'y')}, 'has the states'),
        ({'mean': np.full(4, np.nan)}, 'holds NaN or infinity'),
        ({'covariance': np.full((4, 4), np.nan)}, 'holds NaN or infinity'),
        ({'covariance': P + np.triu(np.full((4, 4), 0.01), 1)}, 'not symmetric with a positive diagonal'),
        ({'covariance': np.diag([1.0, 1.0, 0.0, 1.0])}, 'not symmetric with a positive diagonal'),
        ({'covariance': np.ones((4, 4))}, 'singular or indefinite'),
    ]:
        with pytest.raises(TrackingError, match=message):
            check_usable(good._replace(**field))


def test_constant_noise_of_a_batch_has_its_batch():
    assert constant_noise(np.ones((7, 12)))(np.zeros((7, 8, 4))).shape == (7, 1, 12)

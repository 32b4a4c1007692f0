"""Estimators of system A and the fusion of what they say."""

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import LOOP, properties, seeds
from random_q_cases import GIVEN, IDS, Z, epoch, locals_of

from wsn_tracking.bags.estimates import differences
from wsn_tracking.errors import TrackingError
from wsn_tracking.fusion import covariance_intersection as ci
from wsn_tracking.trackers.estimate import Kind, check_usable
from wsn_tracking.trackers.estimator import EstimatorConfig, make_estimator
from wsn_tracking.trackers.fusing import Fuser, FusionConfig, compared
from wsn_tracking.trackers.random_q_config import NoiseConfig, RandomQConfig, ReacquireConfig, StartConfig


@properties
@given(seeds, st.sampled_from(['trace', 'optimal', 'lci', 'mean', 'ici']), st.permutations(range(3)))
def test_fusion_does_not_depend_on_neighbour_order(seed, rule, order):
    fused, shuffled = Fuser(FusionConfig(rule=rule), 'fused_1'), Fuser(FusionConfig(rule=rule), 'fused_1')
    for k in range(3):
        here = locals_of(seed + k, k=k)
        assert differences([fused.step(here)], [shuffled.step([here[i] for i in order])]) == []


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
    assert differences([fuser.step(again)], [Fuser(config, 'fused_1').step(again)]) == []


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


@pytest.mark.parametrize(
    ('config', 'message'),
    [
        (RandomQConfig(noise=NoiseConfig(q_min=3.0, q_max=2.0)), '`noise.q_max` 2 is below `noise.q_min` 3'),
        (RandomQConfig(noise=NoiseConfig(q_min=0.0, q_max=0.0)), '`noise.q_max` is 0'),
        (RandomQConfig(noise=NoiseConfig('acceleration', spectral_density=0.0)), '`noise.spectral_density` is 0'),
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

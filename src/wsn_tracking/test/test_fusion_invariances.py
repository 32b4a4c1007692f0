"""What holds of every rule of fusion: order, units, frames, batches, one alone."""

import numpy as np
import pytest
from fusion_cases import estimates
from hypothesis import given
from hypothesis import strategies as st
from oracles import properties, seeds

from wsn_tracking.fusion import covariance_intersection as fusion

RULES = {'trace': fusion.trace, 'optimal': fusion.optimal, 'ici': fusion.ici, 'mean': fusion.mean, 'lci': fusion.lci}
rules = st.sampled_from(list(RULES.values()))


@properties
@given(seeds, st.integers(2, 5), st.permutations(range(5)))
def test_neighbours_may_come_in_any_order(seed, J, order):
    m, P = estimates(seed, J)
    order = [j for j in order if j < J]
    for rule in (fusion.trace, fusion.optimal, fusion.mean, fusion.lci):
        fused, shuffled = rule(m, P), rule(m[order], P[order])
        tolerance = 1e-7 if rule is fusion.optimal else 1e-12  # of the mean: where the optimum is flat
        np.testing.assert_allclose(shuffled.m, fused.m, atol=tolerance * max(1.0, np.abs(m).max()))
        np.testing.assert_allclose(np.trace(shuffled.P), np.trace(fused.P), rtol=1e-12)


@properties
@given(rules, seeds, st.integers(1, 4), st.floats(1e-3, 1e3))
def test_units_do_not_matter(rule, seed, J, unit):
    m, P = estimates(seed, J, condition=100.0)
    here, there = rule(m, P), rule(unit * m, unit**2 * P)
    # where the least trace is flat, its weights are known to the root of the precision
    np.testing.assert_allclose(there.m, unit * here.m, rtol=1e-6, atol=unit * 1e-6)
    np.testing.assert_allclose(there.P, unit**2 * here.P, rtol=1e-5, atol=unit**2 * 1e-6)


@properties
@given(rules, seeds, st.integers(1, 4))
def test_rotation_and_shift_of_the_frame_do_not_matter(rule, seed, J):
    m, P = estimates(seed, J, condition=100.0)
    rng = np.random.default_rng(seed)
    U, shift = np.linalg.qr(rng.standard_normal((4, 4)))[0], rng.standard_normal(4)
    here, there = rule(m, P), rule(m @ U.T + shift, U @ P @ U.T)  # as above of flat minima
    np.testing.assert_allclose(there.m, here.m @ U.T + shift, atol=1e-6)
    np.testing.assert_allclose(there.P, U @ here.P @ U.T, atol=1e-6)


@pytest.mark.parametrize('name', RULES)
def test_a_batch_equals_its_sets_one_by_one(name):
    m, P = estimates(12, 4, 2, 3)
    batch = RULES[name](m, P)
    for i in np.ndindex(4, 2):
        one = RULES[name](m[i], P[i])
        np.testing.assert_allclose(batch.m[i], one.m, rtol=1e-9, atol=1e-10)
        np.testing.assert_allclose(batch.P[i], one.P, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize('name', RULES)
def test_one_estimate_alone_stays_itself(name):
    m, P = estimates(13, 1)
    fused = RULES[name](m, P)
    np.testing.assert_allclose(fused.m, m[0], rtol=1e-9)
    assert np.isnan(fused.P).all() or np.allclose(fused.P, P[0], rtol=1e-9)

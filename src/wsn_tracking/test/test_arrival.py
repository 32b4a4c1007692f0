"""The two-state chain of arrivals, links that lose, and draws that are keyed."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import properties

from wsn_tracking.models.arrival import CLIP, Arrival, chain, kept, posterior, predicted
from wsn_tracking.models.links import Links, hashed_uniform, is_cut, lost

shares = st.floats(0.01, 0.99)


@given(shares, shares, shares)
@properties
def test_prediction_is_the_transition_matrix(p, q, mu):
    transition = np.array([[1 - q, q], [p, 1 - p]])
    assert predicted(Arrival(p, q), np.array(mu)) == pytest.approx((np.array([1 - mu, mu]) @ transition)[1])


@given(shares, st.floats(-5, 5), st.floats(-5, 5))
@properties
def test_posterior_is_bayes_rule(pi_1, l1, l0):
    bayes = pi_1 * np.exp(l1) / (pi_1 * np.exp(l1) + (1 - pi_1) * np.exp(l0))
    assert posterior(np.array(pi_1), np.array(l1), np.array(l0)) == pytest.approx(bayes, rel=1e-9)


def test_posterior_decides_where_likelihoods_underflow():
    """exp(-2000) is no number; its ratio to exp(-2003) is."""
    assert posterior(np.array(0.5), np.array(-2000.0), np.array(-2003.0)) == pytest.approx(1 / (1 + np.exp(-3)))
    assert posterior(np.array(0.9), np.array(-1e9), np.array(-7.0)) == 0.0
    assert posterior(np.array(0.1), np.array(-5.0), np.array(-np.inf)) == 1.0


def test_what_is_kept_rules_nothing_out():
    assert kept(np.array([0.0, 0.3, 1.0])).tolist() == [CLIP, 0.3, 1 - CLIP]
    assert predicted(Arrival(), kept(np.array(0.0))) == pytest.approx(0.4, abs=1e-5)


def test_chain_has_the_rates_it_was_given():
    r = chain(Arrival(0.05, 0.4, 0.8), np.random.default_rng(1).random((40, 300, 50)))
    before, after = r[:, :-1], r[:, 1:]
    assert np.mean(~after[before]) == pytest.approx(0.05, abs=0.002)
    assert np.mean(after[~before]) == pytest.approx(0.4, abs=0.006)
    assert np.mean(r[:, 0]) == pytest.approx(0.8, abs=0.03)
    assert np.mean(r[:, 100:]) == pytest.approx(0.4 / 0.45, abs=0.004)


def test_chain_without_epochs_is_empty():
    assert chain(Arrival(), np.empty((0, 3))).shape == (0, 3)


def test_hashed_numbers_are_uniform_and_independent():
    u = hashed_uniform(3, np.arange(200)[:, None, None], np.arange(20)[:, None], np.arange(30))
    assert u.mean() == pytest.approx(0.5, abs=0.003)
    assert np.histogram(u, 10, (0, 1))[0] == pytest.approx(np.full(10, 12000), rel=0.05)
    for axis in range(3):
        a, b = np.delete(u, 0, axis).ravel(), np.delete(u, -1, axis).ravel()
        assert abs(np.corrcoef(a, b)[0, 1]) < 0.01
    assert np.unique(u).size == u.size


def test_a_loss_depends_on_its_key_alone():
    links = Links(loss=0.3)
    whole = lost(links, 5, 7, np.arange(20)[:, None], np.arange(50), 9)
    assert whole.mean() == pytest.approx(0.3, abs=0.05)
    assert lost(links, 5, 7, 4, 11, 9) == whole[4, 11]
    keys = [(6, 7, 4, 9), (5, 8, 4, 9), (5, 7, 5, 9), (5, 7, 4, 10)]
    assert all(not np.array_equal(whole[4], lost(links, s, k, t, np.arange(50), to)) for s, k, t, to in keys)
    assert not lost(Links(), 5, 7, 4, np.arange(50), 9).any()


def test_a_cut_parts_the_sides_of_a_line_for_some_epochs():
    links = Links(cut_at=2.0, cut_from=3, cut_until=5)
    x = np.array([0.0, 1.9, 2.0, 9.0])
    assert is_cut(links, 4, x[:, None], x).tolist() == [[i // 2 != j // 2 for j in range(4)] for i in range(4)]
    assert not any(is_cut(links, k, x[:, None], x).any() for k in (2, 5))

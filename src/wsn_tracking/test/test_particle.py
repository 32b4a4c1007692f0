"""The particle filter's parts against exact answers: a grid filter, brute force, complete paths."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import properties

from wsn_tracking.filters.adaptive import Kld, bound, enough
from wsn_tracking.filters.ancestry import Ancestry
from wsn_tracking.filters.particle import Cloud, descended, equal, log_sum, moments, resampled, reweighed, taken, worth
from wsn_tracking.filters.resampling import systematic


def cloud(*batch, P=50, S=3, seed=1):
    rng = np.random.default_rng(seed)
    log_w = np.log(rng.dirichlet(np.ones(P), batch or None))
    return Cloud(rng.standard_normal((*batch, S, P)), log_w)


# --- weights


@properties
@given(
    l=st.lists(st.floats(-1e4, 1e3), min_size=1, max_size=30),
    impossible=st.lists(st.booleans(), min_size=1, max_size=30),
)
def test_log_sum_is_that_of_the_textbook_where_nothing_underflows(l, impossible):
    l = np.array(l)
    top = l.max()
    np.testing.assert_allclose(log_sum(l), top + np.log(np.sum(np.exp(l - top))), rtol=1e-12, atol=1e-12)
    l[np.resize(impossible, l.size)] = -np.inf
    assert not np.isnan(log_sum(l))
    assert (log_sum(l) == -np.inf) == np.all(l == -np.inf)


def test_evidence_is_the_weighted_mean_of_the_likelihood():
    before = cloud(4)
    l = np.random.default_rng(2).standard_normal((4, 50))
    after, evidence = reweighed(before, l)
    np.testing.assert_allclose(np.exp(evidence), np.sum(before.w * np.exp(l), axis=-1), rtol=1e-13)
    np.testing.assert_allclose(after.w, before.w * np.exp(l) / np.exp(evidence)[:, None], rtol=1e-13)
    np.testing.assert_allclose(after.w.sum(axis=-1), 1.0, rtol=1e-13)


def test_weights_survive_likelihoods_that_underflow():
    before = cloud()
    l = -1e5 - np.arange(50.0)
    after, evidence = reweighed(before, l)
    np.testing.assert_allclose(after.w.sum(), 1.0)
    _, shifted = reweighed(before, l + 1e5)
    assert evidence == pytest.approx(shifted - 1e5)


def test_what_no_particle_can_explain_changes_nothing_and_only_there():
    before = cloud(2)
    l = np.zeros((2, 50))
    l[0] = -np.inf
    l[1, :40] = -np.inf
    after, evidence = reweighed(before, l)
    np.testing.assert_array_equal(after.log_w[0], before.log_w[0])
    assert evidence[0] == -np.inf
    assert after.w[1, 40:].sum() == pytest.approx(1.0)


def test_two_observations_at_once_or_one_by_one_are_the_same():
    before = cloud()
    a, b = np.random.default_rng(3).standard_normal((2, 50))
    first, one = reweighed(before, a)
    second, two = reweighed(first, b)
    both, evidence = reweighed(before, a + b)
    np.testing.assert_allclose(second.log_w, both.log_w, atol=1e-12)
    assert one + two == pytest.approx(evidence)


def test_moments_are_those_of_numpy():
    values, w = cloud(3).s, cloud(3).w
    m, P = moments(values, w, 0.1)
    for r in range(3):
        np.testing.assert_allclose(m[r], np.average(values[r], axis=-1, weights=w[r]), atol=1e-14)
        np.testing.assert_allclose(P[r], np.cov(values[r], aweights=w[r], ddof=0) + 0.01 * np.eye(3), atol=1e-14)
    np.testing.assert_array_equal(P, np.swapaxes(P, -1, -2))


def test_worth_counts_equal_particles():
    assert worth(np.full(40, 1.0 / 40.0)) == pytest.approx(40.0)
    assert worth(np.r_[1.0, np.zeros(39)]) == pytest.approx(1.0)
    w = np.r_[np.full(10, 0.1), np.zeros(30)]
    np.testing.assert_allclose(worth(np.stack([w, w[::-1]])), 10.0)


# --- resampling of clouds


def test_resampling_is_only_where_it_is_wanted():
    before = cloud(3)
    after, parents = resampled(before, systematic, np.random.default_rng(1), np.array([False, True, False]))
    for r in (0, 2):
        np.testing.assert_array_equal(after.s[r], before.s[r])
        np.testing.assert_array_equal(after.log_w[r], before.log_w[r])
        np.testing.assert_array_equal(parents[r], np.arange(50))
    np.testing.assert_array_equal(after.s[1], before.s[1][:, parents[1]])
    np.testing.assert_allclose(after.w[1], 1.0 / 50.0)
    nothing = resampled(before, systematic, np.random.default_rng(1), np.zeros(3, dtype=bool))
    assert nothing.cloud is before
    assert nothing.parents is None


@pytest.mark.parametrize('n', [20, 130])
def test_resampling_to_another_number_keeps_the_mean(n):
    before = cloud(400)
    after, parents = resampled(before, systematic, np.random.default_rng(2), n=n)
    assert after.s.shape == (400, 3, n)
    assert parents.shape == (400, n)
    gap = moments(after.s, after.w)[0] - moments(before.s, before.w)[0]
    assert np.abs(gap.mean(axis=0)).max() < 5.0 / np.sqrt(400 * n)


# --- a whole filter against exact ones


def test_one_dimension_is_that_of_a_grid_filter():
    """Random walk, a reading that is not linear: means, variances and evidence against a dense grid (dx = 2 cm)."""
    rng = np.random.default_rng(7)
    dt_std, noise, P, epochs = 0.4, 0.5, 20_000, 12

    def h(x):
        return np.abs(x) + 0.3 * np.sin(2.0 * x)

    truth = 1.0 + np.cumsum(dt_std * rng.standard_normal(epochs))
    z = h(truth) + noise * rng.standard_normal(epochs)
    grid = np.arange(-9.0, 9.0, 0.02)
    density = np.exp(-0.5 * grid**2 / 4.0)
    density /= density.sum()
    kernel = np.exp(-0.5 * ((grid[:, None] - grid) / dt_std) ** 2)
    kernel /= kernel.sum(axis=0)
    c = equal(2.0 * rng.standard_normal((1, P)))
    for k in range(epochs):
        density = kernel @ density
        likelihood = np.exp(-0.5 * ((z[k] - h(grid)) / noise) ** 2)
        exact_evidence = np.log(np.sum(density * likelihood))
        density = density * likelihood / np.exp(exact_evidence)
        c = Cloud(c.s + dt_std * rng.standard_normal(c.s.shape), c.log_w)
        c, evidence = reweighed(c, -0.5 * ((z[k] - h(c.s[0])) / noise) ** 2)
        m, V = moments(c.s, c.w)
        mean = np.sum(density * grid)
        assert m[0] == pytest.approx(mean, abs=0.04)  # standard error 0.005 to 0.01 with some 5000 that count
        assert V[0, 0] == pytest.approx(np.sum(density * (grid - mean) ** 2), rel=0.06, abs=0.005)
        assert evidence == pytest.approx(exact_evidence, abs=0.04)
        c, _ = resampled(c, systematic, rng, worth(c.w) < 0.5 * P)


# --- ancestors


@pytest.mark.parametrize('batch', [(), (3,)])
def test_ancestors_are_those_of_whole_paths(batch):
    """Every particle carries its own path; the ancestry must find the same from parents alone."""
    rng = np.random.default_rng(8)
    P, lag = 6, 2.0
    past = Ancestry(lag)
    paths, parents = np.empty((*batch, 0, P)), None
    for k in range(12):
        if k:
            parents = None if k % 3 == 0 else rng.integers(0, P, (*batch, P))
            if parents is not None:
                paths = taken(paths, parents)
        x = rng.standard_normal((*batch, 1, P))
        paths = np.concatenate([paths, x], axis=-2)
        t = 0.5 * k
        past.add(t, x, np.ones((*batch, 1, 1)), parents)
        for then in (t, t - 0.5, t - 0.8, t - 1.5, t - lag):
            at = np.maximum(then / 0.5, 0.0)
            low = int(at)
            high = min(low + 1, k)
            expected = paths[..., low, :] + (at - low) * (paths[..., high, :] - paths[..., low, :])
            np.testing.assert_allclose(past.at(then).values[..., 0, :], expected, atol=1e-12)
            assert past.before(then) == (then >= 0.0)
    assert len(past._generations) == 5  # 2 s of half a second each, and the end
    past.clear()
    assert not past.before(0.0)


def test_ancestors_are_found_among_another_number_of_particles():
    past = Ancestry(1.0)
    past.add(0.0, np.array([[10.0, 20.0, 30.0]]), np.eye(1), None)
    past.add(0.5, np.array([[1.0, 2.0]]), np.eye(1), np.array([2, 0]))
    past.add(1.0, np.array([[1.0, 2.0, 3.0, 4.0]]), np.eye(1), np.array([0, 0, 1, 1]))
    np.testing.assert_array_equal(past.at(0.0).values, [[30.0, 30.0, 10.0, 10.0]])
    np.testing.assert_array_equal(past.at(0.0).ancestors, [2, 2, 0, 0])


@pytest.mark.parametrize('batch', [(), (2,)])
def test_few_ancestors_do_not_claim_to_know_more_than_was_known_then(batch):
    """Of n equal ancestors the mean is off by 1/n of what was not known; of one, by all of it."""
    past = Ancestry(1.0)
    known = np.broadcast_to(9.0 * np.eye(1), (*batch, 1, 1))
    past.add(0.0, np.broadcast_to([[1.0, 2.0, 5.0]], (*batch, 1, 3)), known, None)
    for parents, mean, variance in (([2, 2, 2], 5.0, 9.0), ([1, 2, 2], 3.5, 2.25 + 4.5)):
        then = Ancestry(1.0)
        then._generations.extend(past._generations)
        then.add(1.0, np.zeros((*batch, 1, 3)), known, np.broadcast_to(parents, (*batch, 3)))
        m, P = then.moments(0.0, np.broadcast_to([0.5, 0.25, 0.25], (*batch, 3)))
        np.testing.assert_allclose(m, np.full((*batch, 1), mean))
        np.testing.assert_allclose(P, np.full((*batch, 1, 1), variance))


def test_epochs_of_one_instant_do_not_divide_by_zero():
    past = Ancestry(1.0)
    for value in (1.0, 2.0, 3.0):
        past.add(0.0, np.full((1, 2), value), np.eye(1), None)
    assert np.all(np.isfinite(past.at(0.0).values))
    assert np.all(past.at(-1.0).values == 1.0)


def test_parents_of_parents_are_grandparents():
    a, b = np.array([3, 3, 0, 1]), np.array([1, 2, 2, 0])
    np.testing.assert_array_equal(descended(a, b), [3, 0, 0, 3])
    assert descended(None, a) is a
    assert descended(a, None) is a
    assert descended(None, None) is None


# --- how many


def test_bound_is_the_quantile_of_chi_squared():
    stats = pytest.importorskip('scipy.stats')
    for k in (2, 5, 50, 500):
        exact = stats.chi2.ppf(stats.norm.cdf(2.33), k - 1) / (2.0 * 0.05)
        assert bound(k, 0.05, 2.33) == pytest.approx(exact, rel=0.02, abs=1.0)
    assert bound(1, 0.05, 2.33) == 1


def test_more_spread_needs_more_particles_within_bounds():
    rng = np.random.default_rng(9)
    kld = Kld(error=0.05, cell=0.5, least=50, most=3000)
    sizes = [enough(kld, 0.25 + spread * rng.standard_normal((2, 2000))) for spread in (1e-3, 0.5, 2.0, 100.0)]
    assert sizes == sorted(sizes)
    assert sizes[0] == 50
    assert sizes[-1] == 3000
    places = np.array([[-0.1, 0.1, 0.1, 0.1], [0.1, 0.1, 0.1, -0.6]])  # three cells, two of them negative
    assert enough(kld._replace(least=1), places) == bound(3, 0.05, 2.33)

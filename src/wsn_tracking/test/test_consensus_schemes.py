"""Graphs, weights and schemes of consensus, against loops over neighbours."""

import numpy as np
import pytest
from consensus_cases import loop_round, within
from hypothesis import given
from hypothesis import strategies as st
from oracles import properties, seeds

from wsn_tracking.errors import TrackingError
from wsn_tracking.fusion.consensus import SCHEMES, polynomial
from wsn_tracking.fusion.exchange import Exchange
from wsn_tracking.fusion.weights import GAIN, chebyshev_factors, chebyshev_guard, contraction, metropolis
from wsn_tracking.models.graph import adjacency, component_sizes, degrees, diameter, is_connected, reached

sizes = st.integers(1, 12)


def field(seed, nodes, radius=0.45, *batch):
    positions = np.random.default_rng(seed).random((*batch, nodes, 2))
    return adjacency(positions, radius)


def connected(seed, nodes=14):
    """A connected graph."""
    rng = np.random.default_rng(seed)
    while True:
        graph = adjacency(rng.random((nodes, 2)), 0.45)
        if is_connected(graph):
            return graph


def neighbours(graph):
    return [np.flatnonzero(row).tolist() for row in graph]


# --- graphs


@properties
@given(seeds, sizes, st.integers(0, 14))
def test_who_is_reached_is_breadth_first_search(seed, nodes, hops):
    graph = field(seed, nodes, 0.45, 2)
    for one, known in zip(graph, reached(graph, hops), strict=True):
        assert [set(np.flatnonzero(row).tolist()) for row in known] == within(one, hops)


@properties
@given(seeds, sizes)
def test_neighbours_are_those_within_the_radius(seed, nodes):
    positions = np.random.default_rng(seed).random((nodes, 2))
    near = [[i != j and np.hypot(*(a - b)) <= 0.4 for j, b in enumerate(positions)] for i, a in enumerate(positions)]
    assert adjacency(positions, 0.4).tolist() == near


def test_components_and_diameter_of_a_chain_that_breaks():
    chain = np.abs(np.subtract.outer(np.arange(7), np.arange(7))) == 1
    assert (diameter(chain), bool(is_connected(chain))) == (6, True)
    broken = chain.copy()
    broken[2, 3] = broken[3, 2] = False
    assert component_sizes(broken).tolist() == [3.0, 3.0, 3.0, 4.0, 4.0, 4.0, 4.0]
    assert (diameter(broken), bool(is_connected(broken))) == (3, False)
    assert is_connected(np.stack([chain, broken])).tolist() == [True, False]


# --- weights


@properties
@given(seeds, sizes)
def test_metropolis_weights_are_doubly_stochastic_and_follow_the_formula(seed, nodes):
    graph = field(seed, nodes)
    W, d = metropolis(graph, degrees(graph)), graph.sum(axis=1)
    for i, j in np.argwhere(graph):
        assert W[i, j] == pytest.approx(1 / (1 + max(d[i], d[j])))
    np.testing.assert_array_equal(W, W.T)
    assert np.all(W >= 0.0)
    assert np.diag(W) == pytest.approx(1.0 - (W - np.diag(np.diag(W))).sum(axis=1))
    assert W.sum(axis=1) == pytest.approx(1.0)


@properties
@given(seeds, st.integers(2, 10))
def test_the_weight_of_who_is_not_heard_goes_to_the_node_itself(seed, nodes):
    rng, graph = np.random.default_rng(seed), field(seed, nodes, 0.6)
    heard = graph & (rng.random(graph.shape) < 0.6)
    full, some = metropolis(graph, degrees(graph)), metropolis(heard, degrees(graph))
    np.testing.assert_array_equal(some[heard], full[heard])
    assert not some[~heard & ~np.eye(nodes, dtype=bool)].any()
    assert some.sum(axis=1) == pytest.approx(1.0)


@properties
@given(seeds)
def test_contraction_is_the_second_eigenvalue(seed):
    graph = connected(seed)
    W = metropolis(graph, degrees(graph))
    assert contraction(W) == pytest.approx(np.sort(np.abs(np.linalg.eigvals(W)))[-2], abs=1e-9)
    two = np.kron(np.eye(2), W)
    assert contraction(two) == pytest.approx(contraction(W), abs=1e-9)


# --- rounds


@properties
@given(seeds, st.integers(1, 12), st.integers(0, 9))
def test_the_matrix_form_is_the_loop_over_neighbours(seed, nodes, rounds):
    graph = field(seed, nodes)
    x = np.random.default_rng(seed).standard_normal((nodes, 20))
    looped = x
    for _ in range(rounds):
        looped = loop_round(looped, neighbours(graph))
    for name in ('cm', 'icf', 'hcmci'):
        exchange = Exchange(SCHEMES[name], rounds, graph)
        assert exchange.lossless(x, graph, graph).value == pytest.approx(looped, abs=1e-9)
        assert exchange.by_rounds(x, lambda _: graph, graph).value == pytest.approx(looped, abs=1e-9)


@properties
@given(seeds, st.integers(1, 12), st.integers(0, 9))
def test_a_flood_counts_every_id_once(seed, nodes, hops):
    graph = field(seed, nodes)
    x = np.random.default_rng(seed).standard_normal((nodes, 3))
    sums = [sum(x[sorted(known)]) for known in within(graph, hops)]
    exchange = Exchange(SCHEMES['flood'], hops, graph)
    for result in (exchange.lossless(x, graph, graph), exchange.by_rounds(x, lambda _: graph, graph)):
        assert result.value == pytest.approx(np.array(sums), abs=1e-9)
        np.testing.assert_array_equal(result.items, reached(graph, hops))


@properties
@given(seeds)
def test_a_flood_of_diameter_rounds_is_the_sum(seed):
    graph = connected(seed)
    x = np.random.default_rng(seed).standard_normal((14, 3))
    value = Exchange(SCHEMES['flood'], diameter(graph), graph).lossless(x, graph, graph).value
    assert value == pytest.approx(np.broadcast_to(x.sum(axis=0), x.shape), abs=1e-9)


@properties
@given(seeds)
def test_chebyshev_gains_what_its_guard_promises(seed):
    graph = connected(seed)
    W = metropolis(graph, degrees(graph))
    rho = float(contraction(W))
    rounds = chebyshev_guard(rho)
    values = np.linalg.eigvalsh(polynomial(W, np.array(chebyshev_factors(rho, rounds))))
    assert values[-1] == pytest.approx(1.0)
    assert np.abs(values[:-1]).max() <= 1.0 / GAIN + 1e-9
    if rounds > 1:
        fewer = np.linalg.eigvalsh(polynomial(W, np.array(chebyshev_factors(rho, rounds - 1))))
        assert np.abs(fewer[:-1]).max() > 1.0 / GAIN


@properties
@given(seeds)
def test_chebyshev_matrix_form_is_its_rounds(seed):
    graph = connected(seed)
    x = np.random.default_rng(seed).standard_normal((14, 5))
    W = metropolis(graph, degrees(graph))
    rounds = max(chebyshev_guard(float(contraction(W))), 3)
    exchange = Exchange(SCHEMES['chebyshev'], rounds, graph)
    whole, stepwise = exchange.lossless(x, graph, graph), exchange.by_rounds(x, lambda _: graph, graph)
    assert whole.value == pytest.approx(stepwise.value, abs=1e-9)
    assert whole.plain == pytest.approx(stepwise.plain, abs=1e-9)
    assert whole.value.mean(axis=0) == pytest.approx(x.mean(axis=0), abs=1e-9)


def test_chebyshev_falls_back_to_plain_rounds_once_shares_are_lost():
    """All of the first round's: what follows is plain averaging, though nothing more is lost."""
    graph, nothing = connected(1), np.zeros((14, 14), dtype=bool)
    x = np.random.default_rng(1).standard_normal((14, 5))
    lossy = Exchange(SCHEMES['chebyshev'], 30, graph).by_rounds(x, lambda t: graph if t else nothing, graph)
    W = metropolis(graph, degrees(graph))
    assert lossy.value == pytest.approx(np.linalg.matrix_power(W, 29) @ x, abs=1e-9)


def test_who_hears_that_a_neighbour_fell_back_falls_back_too():
    """One node misses the first round; the word spreads by one hop a round, and each hop accelerates until then."""
    chain = np.abs(np.subtract.outer(np.arange(5), np.arange(5))) == 1
    x = np.random.default_rng(2).standard_normal((5, 1))
    deaf = chain.copy()
    deaf[0] = False
    rounds = chebyshev_guard(float(contraction(metropolis(chain, degrees(chain)))))
    exchange = Exchange(SCHEMES['chebyshev'], rounds, chain)
    value = before = x
    for t in range(rounds):
        mixed = metropolis(deaf if t == 0 else chain, degrees(chain)) @ value
        omega = np.where(np.arange(5) <= t, 1.0, exchange.omegas[t])[:, None]
        before, value = value, omega * (mixed - before) + before
    lossy = exchange.by_rounds(x, lambda t: chain if t else deaf, chain)
    assert lossy.value == pytest.approx(value, abs=1e-12)


def test_too_few_rounds_for_chebyshev_are_refused():
    graph = np.abs(np.subtract.outer(np.arange(12), np.arange(12))) == 1
    with pytest.raises(TrackingError, match=r'chebyshev has 5 rounds .* expected at least \d+'):
        Exchange(SCHEMES['chebyshev'], 5, graph)
    with pytest.raises(TrackingError, match=r'contract by 1\.0'):
        chebyshev_guard(1.0)
    assert chebyshev_guard(0.0) == 1


# --- what the schemes make of it


@properties
@given(seeds, st.integers(2, 9))
def test_after_full_agreement_every_scheme_has_the_centralised_information(seed, nodes):
    """With equal priors: P^-1 + sum I, but for hcmci, which claims an average."""
    rng = np.random.default_rng(seed)
    prior, own, n = rng.random(14), rng.random((nodes, 14)), np.full(nodes, float(nodes))
    centralised = prior + own.sum(axis=0)
    for name in ('cm', 'icf', 'chebyshev', 'flood'):
        scheme = SCHEMES[name]
        rows = scheme.start(np.broadcast_to(prior, own.shape), own, n)
        result = rows.sum(axis=0) if scheme.flooded else rows.mean(axis=0)
        after = scheme.finish(np.broadcast_to(prior, own.shape), np.broadcast_to(result, own.shape), n, n)
        assert after == pytest.approx(np.broadcast_to(centralised, own.shape), rel=1e-9), name
    scheme = SCHEMES['hcmci']
    rows = scheme.start(np.broadcast_to(prior, own.shape), own, n)
    assert scheme.finish(prior, rows.mean(axis=0), n, n) == pytest.approx(prior + own.mean(axis=0))


def test_icf_claims_what_there_is_while_the_network_changes():
    """Ten nodes with a prior and a contribution of one each: the prior counts once, as do the contributions at most."""
    scheme, prior, own = SCHEMES['icf'], np.ones((10, 1)), np.ones((10, 1))

    def after(before):
        value = np.broadcast_to(scheme.start(prior, own, np.full(10, before)).mean(axis=0), prior.shape)
        return scheme.finish(prior, value, np.full(10, before), np.full(10, 10.0))[0, 0]

    assert after(10.0) == pytest.approx(11.0)
    assert after(20.0) == pytest.approx(11.0)  # half of the network is gone
    assert after(5.0) == pytest.approx(1.0 + 5.0)  # it has doubled

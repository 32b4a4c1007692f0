"""The channel with a body in it, and its likelihood against one node and one particle at a time."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import properties

from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.models.body import (
    LOS,
    NLOS,
    SINGLE,
    SINGLE_PRINTED,
    Curve,
    Curves,
    about_anchors,
    is_behind,
    mean_rssi,
    single_of,
)
from wsn_tracking.models.body_likelihood import SPAN_DB, BodyLikelihood, Kernel, Readings
from wsn_tracking.models.radio import rssi_at
from wsn_tracking.models.walk import PSI, STATES, YAW, X, Y
from wsn_tracking.models.work import Work

POSITIONS = np.array([[0.0, 0.0, 0.0], [10.0, 0.0, 1.0], [0.0, 12.0, 2.0], [9.0, 11.0, 0.5], [4.0, 5.0, 0.0]])
CURVES = Curves(LOS, NLOS, SINGLE)
KERNELS = [
    Kernel(kind, dof, outlier)
    for kind in ('single', 'max', 'direction', 'soft')
    for dof in (0.0, 3.0)
    for outlier in (0.0, 0.05)
]


# --- the channel


def test_curves_are_the_documents_with_their_names_put_right():
    """LOS is the stronger one from the first metre on, and one curve for both lies in between."""
    d = np.array([1.0, 3.0, 20.0])
    los, nlos, single = (mean_rssi(curve, d) for curve in (LOS, NLOS, SINGLE))
    assert np.all(nlos < single)
    assert np.all(single < los)
    np.testing.assert_allclose(los, [-45.27, -55.7428, -73.8276], atol=1e-4)
    np.testing.assert_allclose(nlos, [-52.92, -65.2154, -86.4475], atol=1e-4)
    assert SINGLE_PRINTED.p_ref == LOS.p_ref


def test_no_node_is_nearer_than_the_chest_lets_it():
    np.testing.assert_array_equal(mean_rssi(LOS, np.array([0.0, 0.1, 0.3])), mean_rssi(LOS, np.full(3, 0.3)))


def test_a_body_beside_other_radios_keeps_its_distance_to_their_curve():
    anchors = make_anchors([1, 2], [[0.0, 0.0], [5.0, 0.0]], p1_dbm=[-40.0, -60.0], n=[2.0, 3.5], d0=[1.0, 2.0])
    d = np.array([4.0, 7.0])
    np.testing.assert_allclose(mean_rssi(single_of(anchors), d), rssi_at(anchors, d))
    moved = about_anchors(CURVES, anchors)
    for curve, base in ((moved.los, LOS), (moved.nlos, NLOS)):
        off = mean_rssi(curve, d) - rssi_at(anchors, d)
        np.testing.assert_allclose(off, mean_rssi(base, d) - mean_rssi(SINGLE, d), atol=1e-12)
    same = make_anchors([1], [[0.0, 0.0]], p1_dbm=SINGLE.p_ref, n=-SINGLE.k / 10.0)
    for curve, base in zip(about_anchors(CURVES, same), CURVES, strict=True):
        assert (curve.p_ref[0], curve.k[0]) == pytest.approx(tuple(base))


def test_who_walks_towards_a_node_does_not_hide_from_it():
    towards = np.array([[3.0, 0.0], [-3.0, 0.0], [0.0, 2.0], [1.0, 1.0]])
    np.testing.assert_array_equal(is_behind(towards, np.array(0.0)), [False, True, True, False])
    np.testing.assert_array_equal(is_behind(towards, np.array([0.0, 3.0]))[1], [True, False, False, True])


# --- the likelihood


@dataclass
class Case:
    s: np.ndarray
    readings: Readings
    w: np.ndarray
    excess: np.ndarray | None


def case(*batch, N=5, P=7, seed=1, lost=0.3, excess=False):
    rng = np.random.default_rng(seed)
    s = np.zeros((*batch, STATES, P))
    s[..., X, :], s[..., Y, :] = 12.0 * rng.random((2, *batch, P))
    s[..., PSI, :], s[..., YAW, :] = 2.0 * rng.standard_normal((2, *batch, P))
    s[..., : Y + 1, 0] = POSITIONS[0, :2] + 0.1  # within the least distance of a node
    z = -65.0 + 10.0 * rng.standard_normal((*batch, N))
    z[rng.random(z.shape) < lost] = np.nan
    sigma = 2.0 + 2.0 * rng.random((*batch, N))
    curves = Curves(*(Curve(c.p_ref + rng.standard_normal(N), c.k - rng.random(N)) for c in CURVES))
    off = 3.0 * rng.standard_normal((*batch, N, P)) if excess else None
    return Case(s, Readings(z, sigma, curves), rng.dirichlet(np.ones(P), batch or None), off)


def density(kernel, e, s):
    if kernel.dof:
        nu = kernel.dof
        c = math.gamma((nu + 1) / 2) / (math.gamma(nu / 2) * math.sqrt(nu * math.pi) * s)
        return c * (1.0 + (e / s) ** 2 / nu) ** (-(nu + 1) / 2)
    return math.exp(-0.5 * (e / s) ** 2) / (s * math.sqrt(2.0 * math.pi))


def slow(kernel, c, height=0.0):
    """log p(z_i | particle), (N, P), of one run: the document's equations one by one; 0 where nothing was heard."""
    z, sigma, curves = c.readings
    l = np.zeros((z.size, c.s.shape[-1]))
    for i in range(z.size):
        if math.isnan(z[i]):
            continue
        for p in range(l.shape[1]):
            dx, dy = POSITIONS[i, 0] - c.s[X, p], POSITIONS[i, 1] - c.s[Y, p]
            d = max(math.sqrt(dx * dx + dy * dy + (POSITIONS[i, 2] - height) ** 2), 0.3)
            off = 0.0 if c.excess is None else c.excess[i, p]
            los, nlos, one = (
                density(kernel, z[i] - off - curve.p_ref[i] - curve.k[i] * math.log10(d), sigma[i]) for curve in curves
            )
            psi = c.s[PSI, p] + c.s[YAW, p]
            ahead = dx * math.cos(psi) + dy * math.sin(psi)
            share = kernel.least + (1 - 2 * kernel.least) / (1 + math.exp(kernel.sharpness * ahead / d))
            value = {
                'single': one,
                'max': max(los, nlos),
                'direction': los if ahead > 0.0 else nlos,
                'soft': (1 - share) * los + share * nlos,
            }[kernel.kind]
            l[i, p] = math.log((1 - kernel.outlier) * value + kernel.outlier / SPAN_DB)
    return l


def check(kernel, c, height=0.0):
    scored = BodyLikelihood(kernel, POSITIONS, height)(c.s, c.readings, c.w, c.excess)
    l = slow(kernel, c, height)
    np.testing.assert_allclose(scored.l, l.sum(axis=0), rtol=1e-9, atol=1e-9)
    heard = ~np.isnan(c.readings.z)
    np.testing.assert_allclose(scored.by_node, np.where(heard, np.log(np.exp(l) @ c.w), 0.0), rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize('kernel', KERNELS, ids=str)
@pytest.mark.parametrize('excess', [False, True])
def test_the_fast_likelihood_is_the_equations_one_by_one(kernel, excess):
    for seed in range(4):
        check(kernel, case(seed=seed, excess=excess), height=1.2)


@properties
@given(
    kernel=st.sampled_from(KERNELS),
    seed=st.integers(0, 10_000),
    sharpness=st.floats(0.0, 20.0),
    least=st.floats(0.01, 0.5),
    lost=st.sampled_from([0.0, 0.5]),
)
def test_the_likelihood_of_any_body_is_the_dense_one(kernel, seed, sharpness, least, lost):
    check(kernel._replace(sharpness=sharpness, least=least), case(seed=seed, lost=lost))


@pytest.mark.parametrize('kernel', KERNELS, ids=str)
def test_one_run_of_a_batch_is_what_it_is_alone(kernel):
    c = case(3, 2, excess=True)
    likelihood = BodyLikelihood(kernel, POSITIONS)
    scored = likelihood(c.s, c.readings, c.w, c.excess)
    for r in np.ndindex(3, 2):
        alone = likelihood(
            c.s[r], Readings(c.readings.z[r], c.readings.sigma[r], c.readings.curves), c.w[r], c.excess[r]
        )
        np.testing.assert_allclose(scored.l[r], alone.l, rtol=1e-10, atol=1e-10)
        np.testing.assert_allclose(scored.by_node[r], alone.by_node, rtol=1e-10, atol=1e-10)


@pytest.mark.parametrize('kernel', KERNELS, ids=str)
def test_what_was_returned_is_not_changed_by_the_next_call(kernel):
    likelihood = BodyLikelihood(kernel, POSITIONS)
    one, other = case(seed=1), case(seed=2, P=9)
    first = likelihood(one.s, one.readings, one.w)
    kept, inputs = (first.l.copy(), first.by_node.copy()), (one.s.copy(), one.readings.z.copy())
    likelihood(other.s, other.readings, other.w, np.ones((5, 9)))
    np.testing.assert_array_equal(first.l, kept[0])
    np.testing.assert_array_equal(first.by_node, kept[1])
    np.testing.assert_array_equal(one.s, inputs[0])
    np.testing.assert_array_equal(one.readings.z, inputs[1])


def test_silence_says_nothing():
    c = case(lost=1.1)
    for batch in (c.readings, Readings(c.readings.z[None], c.readings.sigma[None], c.readings.curves)):
        s = c.s if batch.z.ndim == 1 else c.s[None]
        scored = BodyLikelihood(Kernel('soft', outlier=0.02), POSITIONS)(s, batch, np.full((*s.shape[:-2], 7), 1 / 7))
        assert not np.any(scored.l)
        assert not np.any(scored.by_node)


@pytest.mark.parametrize('outlier', [1e-9, 0.02, 0.5])
def test_hundreds_of_absurd_readings_do_not_underflow(outlier):
    """The product over nodes is taken in as many parts as double precision needs."""
    N = 400
    positions = np.column_stack([np.arange(float(N)), np.zeros(N), np.zeros(N)])
    s = np.zeros((STATES, 3))
    s[X] = [0.0, 200.0, 1e6]
    readings = Readings(np.full(N, 10.0), np.full(N, 0.5), CURVES)
    scored = BodyLikelihood(Kernel('soft', outlier=outlier), positions)(s, readings, np.full(3, 1 / 3))
    floor = math.log(outlier / SPAN_DB)
    np.testing.assert_allclose(scored.l, N * floor, rtol=1e-6)
    np.testing.assert_allclose(scored.by_node, floor, rtol=1e-6)


def test_without_outliers_absurd_readings_still_tell_near_from_far():
    s = np.zeros((STATES, 2))
    s[X] = [1.0, 500.0]
    scored = BodyLikelihood(Kernel('max'), POSITIONS)(s, Readings(np.full(5, 20.0), np.full(5, 0.5), CURVES))
    assert np.all(np.isfinite(scored.l))
    assert scored.l[0] > scored.l[1] + 1000.0
    assert scored.by_node is None


def test_places_far_from_the_origin_are_told_as_well():
    """Maps are in metres of some grid: the squares of such coordinates would swallow the distances."""
    c = case(seed=3)
    away = np.array([4.5e5, 5.4e6])
    moved = c.s.copy()
    moved[: Y + 1] += away[:, None]
    there = POSITIONS + np.r_[away, 0.0]
    near = BodyLikelihood(Kernel('soft'), POSITIONS)(c.s, c.readings)
    far = BodyLikelihood(Kernel('soft'), there)(moved, c.readings)
    np.testing.assert_allclose(far.l, near.l, rtol=1e-6)


def test_work_arrays_are_kept_and_grow():
    work = Work()
    a = work.of('a', (2, 3))
    assert work.of('a', (3, 2)).base is a.base
    assert work.of('b', (2, 3)).base is not a.base
    assert work.of('a', (4, 5)).shape == (4, 5)
    assert work.of('a', (2, 2)).base is work.of('a', (4, 5)).base

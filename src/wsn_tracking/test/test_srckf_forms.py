"""Both forms of the square-root filter, by QR and by Gram matrices, give the same, also near singularity."""

import numpy as np
from belief_cases import F, close, drawn
from hypothesis import given
from hypothesis import strategies as st
from oracles import NOISE, H, beliefs, properties, seeds

from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.srckf import FORMS, predict, update

TELLS_NOTHING = 1e-5  # of a standard deviation: what an estimate could never show


def scaled(noise):
    """The usual noise, by so many powers of ten."""
    return lambda x: 10.0**noise * NOISE(x)


@properties
@given(seeds, st.floats(-9.0, 3.0), st.floats(-6.0, 2.0), st.sampled_from([(), (3,), (80,)]))
def test_both_forms_agree_also_where_one_of_them_is_near_singular(seed, noise, spread, batch):
    """Noise roots from 1e-9 to 1e3 times the usual ones, beliefs from micrometres to a hundred metres wide."""
    wide = 10.0**spread
    belief, z = drawn(seed, *batch, noise=0.12 * 10.0**noise, position_std=wide, velocity_std=wide)
    exact, other = (update(belief, z, H, scaled(noise), form=form) for form in ('qr', 'gram'))
    close(other, exact.m, exact.P, TELLS_NOTHING)


@properties
@given(seeds, st.floats(-3.0, 3.0), st.floats(-3.0, 1.0), st.integers(2, 5))
def test_both_forms_iterate_alike(seed, noise, spread, passes):
    belief, z = drawn(seed, 3, noise=0.12 * 10.0**noise, position_std=10.0**spread)
    exact, other = (update(belief, z, H, scaled(noise), passes, form=form) for form in ('qr', 'gram'))
    close(other, exact.m, exact.P, TELLS_NOTHING)


@properties
@given(seeds, st.floats(-12.0, 0.0))
def test_both_forms_of_the_prediction_agree_also_for_singular_noise(seed, exponent):
    rng = np.random.default_rng(seed)
    m, P = beliefs(rng, 70)
    belief = Belief(m, np.linalg.cholesky(P))
    scale = 10.0**exponent
    for A, root in (
        (F, scale * np.eye(4)),
        (scale * F, np.zeros((4, 4))),
        (np.zeros((4, 4)), scale * np.diag([1, 1, 0, 0])),
    ):
        one, other = predict(belief, A, root, 'gram'), predict(belief, A, root, 'qr')
        np.testing.assert_array_equal(one.m, other.m)
        size = np.abs(other.P).max()
        np.testing.assert_allclose(one.P / size, other.P / size, atol=1e-10)
        assert np.all(np.isfinite(one.chol_P))


@properties
@given(seeds, st.integers(1, 3), st.sampled_from([0.0, 1.5]))
def test_regressing_over_the_states_that_are_seen_changes_nothing(seed, passes, kappa):
    belief, z = drawn(seed, 3)
    for form in FORMS:
        whole = update(belief, z, H, NOISE, passes, kappa, form=form)
        seen = update(belief, z, H, NOISE, passes, kappa, seen=2, form=form)
        close(seen, whole.m, whole.P, 1e-8)

"""What holds of any update of a belief."""

import numpy as np
from belief_cases import drawn, forms
from hypothesis import given
from hypothesis import strategies as st
from oracles import LOOP, NOISE, H, at_least, properties, seeds

from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.srckf import update
from wsn_tracking.models.measurement import range_function, relative_noise


@properties
@given(seeds, st.sampled_from([1, 2, 3, 10]), forms)
def test_an_update_never_knows_less_than_before(seed, passes, form):
    belief, z = drawn(seed, 4, silent=0.3, position_std=0.5)
    after = update(belief, z, H, NOISE, passes, form=form)
    assert np.all(np.isfinite(after.m))
    assert np.all(np.diagonal(after.chol_P, axis1=-2, axis2=-1) > 0.0)
    np.testing.assert_array_equal(after.chol_P, np.tril(after.chol_P))
    assert at_least(belief.P, after.P)


def test_a_target_on_top_of_a_node_is_no_number_that_breaks_the_filter():
    at_node = np.concatenate([LOOP.anchors.positions[5, :2], [0.0, 0.0]])
    z = np.full(12, np.nan)
    z[5] = 0.01
    for std in (1e-4, 1e-2, 1.0):
        for passes in (1, 3):
            after = update(Belief(at_node, std * np.eye(4)), z, H, NOISE, passes)
            assert np.all(np.isfinite(after.m))
            assert np.all(np.diagonal(after.chol_P) > 0.0)


@properties
@given(seeds, st.floats(-1e3, 1e3), st.floats(-1e3, 1e3))
def test_a_filter_does_not_care_where_the_origin_is(seed, x, y):
    belief, z = drawn(seed)
    moved = LOOP.anchors._replace(positions=LOOP.anchors.positions + np.array([x, y, 0.0]))
    h = range_function(moved)
    shift = np.array([x, y, 0.0, 0.0])
    there = update(Belief(belief.m + shift, belief.chol_P), z, h, relative_noise(moved, h), 3)
    here = update(belief, z, H, NOISE, 3)
    np.testing.assert_allclose(there.m - shift, here.m, atol=1e-8)
    np.testing.assert_allclose(there.P, here.P, atol=1e-8)

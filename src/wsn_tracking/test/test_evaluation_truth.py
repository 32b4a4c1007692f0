"""The truth between its samples, and where it is not known."""

import numpy as np
from evaluation_cases import SECOND, T0, line_truth
from hypothesis import given
from hypothesis import strategies as st

from wsn_tracking.evaluation.interpolation import Verdict, truth_at
from wsn_tracking.sensing.recording import Truth


def test_truth_at_a_recorded_stamp_is_the_recorded_position():
    truth = line_truth()
    at = truth_at(truth, truth.stamps_ns)
    np.testing.assert_array_equal(at.positions, truth.positions)
    assert np.all(at.verdicts == Verdict.SCORED)


@given(st.integers(0, 29 * SECOND))
def test_truth_between_stamps_is_on_the_line(after_ns):
    at = truth_at(line_truth(), np.array([T0 + after_ns]))
    expected = np.array([2.0, 1.0]) + after_ns * 1e-9 * np.array([1.0, 0.5])
    np.testing.assert_allclose(at.positions[0, :2], expected, rtol=0, atol=1e-9)


def test_one_nanosecond_is_not_lost_in_a_stamp_of_today():
    # A double of seconds since 1970 has steps of 240 ns.
    truth = Truth(1, np.array([T0, T0 + 4]), np.array([[0.0, 0, 0], [4.0, 0, 0]]), np.zeros((2, 3)))
    at = truth_at(truth, T0 + np.arange(5))
    np.testing.assert_array_equal(at.positions[:, 0], [0.0, 1.0, 2.0, 3.0, 4.0])


def test_truth_is_unknown_outside_and_within_a_long_gap_but_not_at_its_ends():
    truth = line_truth(4)
    positions, stamps = truth.positions[[0, 1, 3]], truth.stamps_ns[[0, 1, 3]]
    holed = truth._replace(positions=positions, stamps_ns=stamps)
    asked = T0 + np.array([-1, 0, SECOND, 2 * SECOND, 3 * SECOND, 3 * SECOND + 1])
    verdicts = truth_at(holed, asked, gap_s=1.5).verdicts
    names = [Verdict(v).name for v in verdicts]
    assert names == ['OUTSIDE_TRUTH', 'SCORED', 'SCORED', 'TRUTH_GAP', 'SCORED', 'OUTSIDE_TRUTH']
    assert np.all(truth_at(holed, asked, gap_s=2.0).verdicts[1:5] == Verdict.SCORED)


def test_nan_rows_of_the_truth_count_as_not_recorded():
    truth = line_truth(6)
    truth.positions[2:5] = np.nan
    verdicts = truth_at(truth, truth.stamps_ns).verdicts
    np.testing.assert_array_equal(verdicts, [0, 0, *[Verdict.TRUTH_GAP] * 3, 0])
    truth.positions[:] = np.nan
    assert np.all(truth_at(truth, truth.stamps_ns).verdicts == Verdict.OUTSIDE_TRUTH)

"""Steps of time that system E bears: none, backwards, and silence of any length."""

import numpy as np
import pytest
from loss_cases import EPOCHS, FILTERS, SECOND, TRUTH, WORLD, errors, is_usable, tracked

from wsn_tracking.sensing.values import Epoch
from wsn_tracking.trackers.loss_tolerant_config import LossTolerantConfig, RestartConfig, TurnConfig


@pytest.mark.parametrize('name', FILTERS)
@pytest.mark.parametrize('gap', [0, -5, -3600, 1, 40, 3600, 10**6])
def test_any_step_in_time_is_bounded_and_finite(name, gap):
    """Seconds between epochs 49 and 50; what comes after keeps its distances."""
    moved = [e._replace(stamp_ns=e.stamp_ns + (gap - 1) * SECOND * (k >= 50)) for k, e in enumerate(EPOCHS)]
    estimates, tracker = tracked(LossTolerantConfig(filter=name, area=WORLD.area), moved)
    assert all(is_usable(e) for e in estimates)
    low, high = WORLD.area[:2], WORLD.area[2:]
    assert all(np.all((e.mean[:2] >= low) & (e.mean[:2] <= high)) for e in estimates)
    assert tracker.counters['stamp_fell'] == (gap < 0)
    assert tracker.counters['reacquired_after_silence'] == (gap > 30)
    settled = errors(estimates, TRUTH)[70:]
    assert np.sqrt(np.mean(settled**2)) < (25.0 if name in ('hold', 'ekf') else 12.0)


@pytest.mark.parametrize('area', [(), WORLD.area])
def test_an_hour_of_silence_ends_in_a_standstill_and_a_new_start(area):
    silent = [Epoch(1, 50 + k, EPOCHS[49].stamp_ns + (k + 1) * SECOND, ()) for k in range(3600)]
    later = [e._replace(stamp_ns=e.stamp_ns + 3600 * SECOND) for e in EPOCHS[50:]]
    config = LossTolerantConfig(area=area)
    estimates, tracker = tracked(config, [*EPOCHS[:50], *silent[::30], *later])
    quiet = estimates[50 : 50 + len(silent[::30])]
    assert all(is_usable(e) for e in quiet)
    np.testing.assert_array_equal(quiet[-1].mean, quiet[2].mean)
    np.testing.assert_array_equal(quiet[-1].covariance, quiet[2].covariance)
    assert 15.0 < np.sqrt(quiet[-1].covariance[0, 0]) < 200.0
    assert tracker.counters == {'reacquired_after_silence': 1}
    assert np.sqrt(np.mean(errors(estimates[-40:], TRUTH[60:]) ** 2)) < 12.0


def test_without_a_new_start_a_gap_is_bridged_as_far_as_the_horizon():
    config = LossTolerantConfig(turn=TurnConfig(horizon=5.0), reacquire=RestartConfig(silence=0.0))
    late = EPOCHS[50]._replace(stamp_ns=EPOCHS[49].stamp_ns + 3600 * SECOND)
    soon = EPOCHS[50]._replace(stamp_ns=EPOCHS[49].stamp_ns + 5 * SECOND)
    one, other = (tracked(config, [*EPOCHS[:50], e])[0] for e in (late, soon))
    np.testing.assert_array_equal(one[-1].mean, other[-1].mean)

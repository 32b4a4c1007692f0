"""What a network loses on the way to its sink: by link or by round, on its own or in bursts."""

import numpy as np
import pytest

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.arrival import bernoulli, bursts, chain
from wsn_tracking.models.links import Loss, gamma

UNIFORM = np.random.default_rng(3).random((20, 500, 16))


@pytest.mark.parametrize('rate', [0.0, 0.1, 0.5, 0.9, 1.0])
def test_bernoulli_losses_have_their_rate_and_no_memory(rate):
    lost = ~chain(bernoulli(rate), UNIFORM)
    assert lost.mean() == pytest.approx(rate, abs=0.005)  # 160000 draws: five standard deviations
    np.testing.assert_array_equal(lost, 1.0 - rate <= UNIFORM)


@pytest.mark.parametrize(('rate', 'length'), [(0.2, 5.0), (0.5, 4.0), (0.8, 12.0)])
def test_bursts_have_their_rate_and_their_length(rate, length):
    """With 160000 draws and bursts of 4 to 12, rates are known to 0.01 and lengths to 3 %."""
    lost = ~gamma(Loss(rate, length), UNIFORM)
    assert lost[:, 0].mean() == pytest.approx(rate, abs=0.1)  # stationary from the first epoch on
    assert lost.mean() == pytest.approx(rate, abs=0.02)
    ends = lost[:, :-1] & ~lost[:, 1:]
    assert lost[:, :-1].sum() / ends.sum() == pytest.approx(length, rel=0.08)


def test_bursts_as_short_as_chance_are_bernoulli_losses():
    assert bursts(0.5, 2.0) == bernoulli(0.5)
    assert bursts(0.9, 10.0) == pytest.approx(bernoulli(0.9))
    assert bursts(0.0, 5.0).p == 0.0


@pytest.mark.parametrize(
    ('rate', 'length', 'words'), [(0.9, 2.0, 'last 10 epochs in a row'), (1.0, 9.0, 'less than 1')]
)
def test_bursts_that_cannot_be_are_refused(rate, length, words):
    with pytest.raises(TrackingError, match=words):
        gamma(Loss(rate, length), UNIFORM)


def test_a_round_is_lost_as_a_whole():
    whole, single = gamma(Loss(0.4, whole_round=True), UNIFORM), gamma(Loss(0.4), UNIFORM)
    assert np.all(whole == whole[..., :1])
    assert whole.mean() == pytest.approx(0.6, abs=0.02)
    np.testing.assert_array_equal(whole[..., 0], single[..., 0])
    assert not np.all(single == single[..., :1])


def test_more_loss_loses_the_same_and_more():
    few, many = gamma(Loss(0.3), UNIFORM), gamma(Loss(0.6), UNIFORM)
    assert np.all(few | ~many)

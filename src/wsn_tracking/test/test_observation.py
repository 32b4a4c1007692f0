"""A packet becomes range and bearing: freed of its radio, with its noise, NaN where it did not arrive."""

import numpy as np
import pytest

from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.sensing.values import Epoch, Range, RangeBearing, Rssi
from wsn_tracking.trackers.consensus_config import ConsensusConfig, noise_of
from wsn_tracking.trackers.observation import observation_of

ANCHOR = make_anchors([7], [[1.0, 2.0, 0.0]], bias=0.5, scale=2.0)
DEFAULT = noise_of(ConsensusConfig())


def read(packet):
    return observation_of(Epoch(1, 0, 0, (packet,)), ANCHOR, DEFAULT)


def test_a_reading_is_freed_of_its_radios_bias_and_scale():
    z, noise = read(RangeBearing(0, 7, 1, 0, 0, 20.5, 0.3, (4.0, 0.2, 0.2, 0.09)))
    assert z.tolist() == [10.0, 0.3]
    assert noise == pytest.approx(np.array([[1.0, 0.1], [0.1, 0.09]]))
    z, noise = read(Range(0, 7, 1, 0, 0, 2, 20.5, 4.0))
    assert (z[0], np.isnan(z[1]), noise[0, 0]) == (10.0, True, 1.0)
    assert read(Range(0, 7, 1, 0, 0, 2, 20.5)).R[0, 0] == pytest.approx(0.01 / 4.0)


def test_a_signal_strength_is_a_range_with_the_noise_of_its_channel():
    z, noise = read(Rssi(0, 7, 1, 0, 0, -75.0))
    assert z[0] == pytest.approx(10.0)
    assert np.sqrt(noise[0, 0]) == pytest.approx(10.0 * 1.56 * np.log(10) / 30.0)
    assert read(Rssi(0, 7, 1, 0, 0, -75.0, sigma_db=3.12)).R[0, 0] == pytest.approx(4.0 * noise[0, 0])


@pytest.mark.parametrize(
    'packet',
    [
        RangeBearing(0, 7, 1, 0, 0, 5.0, 0.3, (1.0, 0.0, 0.0, 1.0), arrived=False),
        RangeBearing(0, 7, 1, 0, 0, float('nan'), float('inf'), (1.0, 0.0, 0.0, 1.0)),
        RangeBearing(0, 8, 1, 0, 0, 5.0, 0.3, (1.0, 0.0, 0.0, 1.0)),
        Range(0, 7, 1, 0, 0, 2, -3.0, 4.0),
    ],
)
def test_what_did_not_arrive_is_nan(packet):
    assert np.isnan(read(packet).z).all()


@pytest.mark.parametrize(
    'told',
    [
        (float('nan'),) * 4,
        (1.0, 2.0, 2.0, 1.0),
        (-1.0, 0.0, 0.0, 1.0),
        (1.0, 0.1, 0.2, 1.0),
        (1e300, 0.0, 0.0, 1e300),
        (1e-300, 0.0, 0.0, 1.0),
    ],
)
@pytest.mark.filterwarnings('error')
def test_noise_that_is_no_covariance_is_the_default(told):
    noise = read(RangeBearing(0, 7, 1, 0, 0, 5.0, 0.3, told)).R
    assert noise == pytest.approx(DEFAULT * [[0.25, 0.5], [0.5, 1.0]])

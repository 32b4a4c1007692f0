"""The turning target of seed 004 as a world and as a recording."""

from dataclasses import replace

import numpy as np
import pytest

from wsn_tracking.bags.read import read
from wsn_tracking.errors import TrackingError
from wsn_tracking.sensing.values import EpochEnd, Rssi
from wsn_tracking.simulation import e_loss as world
from wsn_tracking.simulation.e_loss import LossConfig, e_loss
from wsn_tracking.simulation.record import record
from wsn_tracking.simulation.scenarios import scenario


def walks(runs=200, config=None):
    config = config or LossConfig()
    return world.walks(config, np.random.default_rng(1).random((runs, world.legs(config), 2)))


def packets(config, seed=3):
    """Signal strengths (K, N) of a recording; NaN where lost."""
    z = np.full((config.epochs, 16), np.nan)
    for m in record(e_loss(config), seed).messages:
        if isinstance(m, Rssi):
            z[m.request_seq, m.node_id - 1] = m.rssi_dbm
    return z


def test_the_field_is_the_designs():
    s = scenario('e_loss')
    assert sorted({*s.anchors.positions[:, 0]}) == pytest.approx([10.0, 110.0 / 3.0, 190.0 / 3.0, 90.0])
    assert s.anchors.positions[:, :2].tolist() == sorted(
        s.anchors.positions[:, :2].tolist(), key=lambda p: (p[1], p[0])
    )
    assert (set(s.anchors.p1_dbm), set(s.anchors.n), set(s.anchors.sigma_db)) == ({-40.0}, {3.0}, {4.0})
    assert (s.truth.shape, s.period, s.entry_level, s.configuration) == ((100, 4), 1.0, 'rssi', 'loss_tolerant')
    assert s.area[:2] <= (0.0, 0.0)
    assert np.all(s.truth[:, :2] >= s.area[:2])
    assert np.all(s.truth[:, :2] <= s.area[2:])


def test_walks_turn_as_the_design_says():
    x = walks()
    np.testing.assert_allclose(x[:, 0, :2], np.tile([20.0, 25.0], (200, 1)))
    np.testing.assert_allclose(np.arctan2(x[:, :15, 3], x[:, :15, 2]), 0.6)
    np.testing.assert_allclose(np.hypot(x[..., 2], x[..., 3]), 3.0)
    inside = np.all((x[..., :2] >= 10.0) & (x[..., :2] <= 90.0), axis=-1)
    rate = np.degrees(x[..., 4])
    assert np.abs(rate[~inside]).max() <= 9.0 + 1e-9
    legs = rate[:, 15:23][inside[:, 15:23].all(axis=1)]
    assert np.all(legs == legs[:, :1])  # one turn a leg
    turns = legs[:, 0]
    for share, of in ((np.mean(turns == 0.0), 'none'), (np.mean(turns > 0.0), 'left')):
        assert share == pytest.approx(1 / 3, abs=0.12), of
    assert (np.abs(turns[turns != 0.0]).min() >= 4.0, np.abs(turns).max() <= 10.0) == (True, True)


def test_who_leaves_comes_back():
    """A turn back at 9 deg/s has a radius of 19 m; about a corner it may take twice that."""
    x = walks(500, LossConfig(epochs=300))
    assert np.all((x[..., :2] > -30.0) & (x[..., :2] < 130.0))
    outside = np.any((x[..., :2] < 10.0) | (x[..., :2] > 90.0), axis=-1)
    longest = max(len(run) for row in outside for run in ''.join('o' if o else ' ' for o in row).split())
    assert longest < 80


def test_what_arrives_is_the_radio_with_its_noise():
    config = LossConfig(loss=0.0)
    s = e_loss(config)
    d = np.hypot(*np.moveaxis(s.truth[:, None, :2] - s.anchors.positions[:, :2], -1, 0))
    e = packets(config) - (-40.0 - 30.0 * np.log10(d))
    assert e.std() == pytest.approx(4.0, rel=0.05)
    assert abs(e.mean()) < 0.4


@pytest.mark.parametrize('loss', [0.1, 0.5, 0.9])
def test_the_rate_of_losses_is_the_configurations(loss):
    assert np.isnan(packets(LossConfig(loss=loss))).mean() == pytest.approx(loss, abs=0.04)


def test_losses_leave_the_noise_of_the_rest_as_it_is():
    all_, some = packets(LossConfig(loss=0.0)), packets(LossConfig(loss=0.5, burst=4.0))
    heard = ~np.isnan(some)
    np.testing.assert_array_equal(some[heard], all_[heard])
    assert not np.isnan(all_).any()


def test_rounds_are_lost_as_a_whole_and_their_epochs_still_end():
    config = LossConfig(loss=0.5, whole_round=True)
    lost = np.isnan(packets(config))
    assert np.all(lost == lost[:, :1])
    ends = [m for m in record(e_loss(config), 3).messages if isinstance(m, EpochEnd)]
    assert [not m.node_ids for m in ends] == lost[:, 0].tolist()
    assert [m.final for m in ends] == [False] * 99 + [True]


def test_seeds_of_walk_and_radio_are_apart():
    config = LossConfig(epochs=20)
    one, other = packets(config), packets(config, seed=4)
    np.testing.assert_array_equal(one, packets(config))
    assert not np.array_equal(one, other, equal_nan=True)
    assert not np.array_equal(e_loss(config).truth[19], e_loss(replace(config, seed=2, epochs=20)).truth[19])


def test_bursts_that_cannot_be_are_refused_at_once():
    with pytest.raises(TrackingError, match=r'bursts of 2 epochs at a loss of 0\.9'):
        scenario('e_loss', {'loss': 0.9, 'burst': 2.0})


def test_the_command_line_takes_the_loss(call, tmp_path):
    assert call('simulate', 'e_loss', '--seed', 1, '--set', 'loss=0.5', '-o', tmp_path / 'bag').code == 0
    recording = read(tmp_path / 'bag')
    heard = sum(isinstance(m, Rssi) for m in recording.messages)
    assert heard == pytest.approx(800, abs=80)  # four standard deviations
    assert recording.metadata['scenario'] == 'e_loss'

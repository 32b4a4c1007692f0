"""Radios as they are: calibrated, with a map of their field, and with links that read wrong."""

from dataclasses import replace

import numpy as np
import pytest
from human_cases import ANCHORS, EPOCHS, FEW, NONSENSE, SECOND, bounded, epochs, packet, run

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.body import SINGLE
from wsn_tracking.models.radio_map import make_map
from wsn_tracking.models.walk import STATES
from wsn_tracking.sensing.channel import Channel, PathLoss, Quantity
from wsn_tracking.sensing.channel_file import save_channel
from wsn_tracking.sensing.values import Epoch
from wsn_tracking.simulation.c_body import BodyConfig
from wsn_tracking.simulation.record import START_NS, TARGET
from wsn_tracking.trackers.human import HumanTracker
from wsn_tracking.trackers.human_config import SignalConfig


def shifted(by):
    """The epochs, with node i read by[i] too much."""
    return [
        e._replace(measurements=tuple(p._replace(rssi_dbm=p.rssi_dbm + by[p.node_id - 1]) for p in e.measurements))
        for e in EPOCHS
    ]


def test_radios_and_their_map_come_from_a_channel_file(tmp_path):
    """Path loss 12 dB higher and a field of +8 dB everywhere: readings 20 dB louder say what the others said."""
    points = np.stack(np.meshgrid(np.arange(-10.0, 120.0, 10.0), np.arange(-10.0, 120.0, 10.0)), axis=-1).reshape(-1, 2)
    p1, n = np.full(16, SINGLE.p_ref + 12.0), np.full(16, -SINGLE.k / 10.0)
    field = np.full((len(points), 16), 8.0)
    radio_map = make_map(ANCHORS.ids, p1, n, points, field, 0.01, 30.0, 100.0, 0.0, 3.0)
    three = [Quantity(value, 0.1 + 0.0 * value, value - 0.2, value + 0.2) for value in (p1, n, np.full(16, 3.0))]
    loss = PathLoss(*three, np.ones(16, int), np.ones(16, int))
    save_channel(tmp_path / 'with_map.yaml', Channel(ANCHORS.ids, loss, None, radio_map, {}))
    save_channel(tmp_path / 'without.yaml', Channel(ANCHORS.ids, loss, None, None, {}))
    config = replace(FEW, signal=SignalConfig(sigma=3.0))
    plain = HumanTracker(config, ANCHORS)
    s = plain._track.cloud.s
    for name, louder in (('with_map', 20.0), ('without', 12.0)):
        tracker = HumanTracker(replace(config, channel=str(tmp_path / f'{name}.yaml')), ANCHORS)
        for epoch, other in zip(EPOCHS, shifted(np.full(16, louder)), strict=True):
            said, same_again = (
                t._filter.score(s, t._table.read(e)[0]).l for t, e in ((tracker, other), (plain, epoch))
            )
            # the file has six digits, the field a noise of 0.01 dB: 1e-3 of what a residual of 60 dB weighs
            np.testing.assert_allclose(said - said.max(), same_again - same_again.max(), rtol=2e-3, atol=0.05)
    with_map = HumanTracker(replace(FEW, channel=str(tmp_path / 'with_map.yaml')), ANCHORS)
    assert with_map.anchors.sigma_db == pytest.approx(np.full(16, 3.0))


OFFSETS = SignalConfig(kind='single', outlier=0.0, offset_std=6.0, offset_time=1e5)


def test_offsets_of_links_are_learnt():
    """Links that read up to 9 dB wrong all the time: told of such links, the filter finds them out."""
    wrong = 9.0 * np.cos(np.arange(16.0) * 2.4)
    sequence, truth = [], epochs(BodyConfig(duration=120.0), 3)[1]
    rng = np.random.default_rng(2)
    for k, place in enumerate(truth):
        d = np.maximum(np.hypot(*(ANCHORS.positions[:, :2] - place[:2]).T), 0.3)
        z = SINGLE.p_ref + SINGLE.k * np.log10(d) + wrong + 2.0 * rng.standard_normal(16)
        packets = tuple(packet(i + 1, z[i], k, 2.0) for i in range(16))
        sequence.append(Epoch(TARGET, k, START_NS + k * SECOND // 2, packets))
    rmse = {}
    for name, signal in {'offsets': OFFSETS, 'none': replace(OFFSETS, offset_std=0.0)}.items():
        tracker = HumanTracker(replace(FEW, particles=1000, signal=signal), ANCHORS)
        error = np.array([e[0].mean[:2] for e in run(tracker, sequence)])[-120:] - truth[-120:, :2]
        rmse[name] = np.sqrt(np.mean(np.sum(error**2, axis=-1)))
        if name == 'offsets':
            b = tracker._track.cloud.s[STATES:].mean(axis=-1)
            assert np.std(b - wrong) < 0.3 * np.std(wrong)
    assert rmse['offsets'] < 0.5 * rmse['none']


def test_offsets_that_are_exactly_known_change_nothing():
    """Standard deviation 1e-9 dB: the filter without offsets."""
    with_, without = (replace(FEW, signal=replace(OFFSETS, offset_std=std)) for std in (1e-9, 0.0))
    for (a,), (b,) in zip(run(HumanTracker(with_, ANCHORS)), run(HumanTracker(without, ANCHORS)), strict=True):
        np.testing.assert_allclose(a.mean, b.mean, rtol=1e-6, atol=1e-6)


def test_offsets_are_for_one_curve():
    with pytest.raises(TrackingError, match=r'offset_std.*single'):
        HumanTracker(replace(FEW, signal=SignalConfig(offset_std=2.0)), ANCHORS)


@pytest.mark.parametrize('kind', sorted(NONSENSE))
def test_nonsense_leaves_offsets_bounded(kind):
    signal = replace(OFFSETS, offset_std=2.5, offset_time=5.0, dof=4.0)
    tracker = HumanTracker(replace(FEW, signal=signal, lag=1.0), ANCHORS)
    run(tracker, EPOCHS[:3])
    for k in range(6):
        bounded(tracker.step(Epoch(TARGET, 3 + k, EPOCHS[3 + k].stamp_ns, NONSENSE[kind](k))))
        assert np.isfinite(tracker._track.cloud.s).all()
        assert ((tracker._track.V >= 0.0) & (tracker._track.V <= 2.5**2 + 1e-9)).all()

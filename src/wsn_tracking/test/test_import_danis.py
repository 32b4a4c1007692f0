"""The BLE tracks: both layouts, every reason to drop a line, and the real data where they are at hand."""

from __future__ import annotations

import gzip
import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from danis_cases import BEACON, EXPONENT, P1, RECEIVERS, T0, WITHIN, dev, flat, line, track
from import_cases import real_data

from wsn_tracking.bags.epochs import with_epoch_ends
from wsn_tracking.bags.importing.danis import calibrated
from wsn_tracking.bags.importing.danis_files import find, read_devices, read_histograms
from wsn_tracking.bags.importing.run import import_set
from wsn_tracking.bags.read import read
from wsn_tracking.errors import TrackingError
from wsn_tracking.sensing.values import EpochEnd, Request, Rssi


def upstream(root: Path) -> Path:
    flat(root)
    (root / 'hst' / 'set_1').mkdir()
    (root / 'hst' / 'set_2').mkdir()
    shutil.move(root / 'hst' / 'set_1_tetam_multi_rssi.hst', root / 'hst' / 'set_1' / 'tetam_multi_rssi.hst')
    (root / 'hst' / 'set_2' / 'tetam_multi_rssi.hst').write_text('Bins:[]')
    (root / 'hst' / 'set_1' / 'sensor10_1.00_1.00_1.85.mbd').write_text('raw')
    (root / 'trk' / 'short').mkdir()
    (root / 'trk' / 'short' / 'sensor10_0.00_0.00_0.00.mbd').write_text('raw')
    return root


def test_both_layouts_give_equal_bags(tmp_path):
    bags = []
    for layout in (flat, upstream):
        (bag,) = import_set('danis', layout(tmp_path / layout.__name__), tmp_path / f'{layout.__name__}_bags')
        assert bag.name == 'danis_short'
        bags.append(next(bag.glob('*.mcap')).read_bytes())
    assert bags[0] == bags[1]


def test_a_packet_is_an_epoch(tmp_path):
    (bag,) = import_set('danis', flat(tmp_path / 'src'), tmp_path / 'out')
    back = read(bag)
    assert with_epoch_ends(back) == back
    requests = [m for m in back.messages if isinstance(m, Request)]
    assert [m.seq for m in requests] == [0, 1, 2, 3, 4]
    assert [m.stamp_ns for m in requests] == [T0 * 10**9 + 450_000_000 * k for k in range(5)]
    for end in (m for m in back.messages if isinstance(m, EpochEnd)):
        assert (end.node_ids, end.seqs) == ((10, 11, 20), (end.request_seq,) * 3)
        assert end.final == (end.request_seq == 4)
    for m in back.messages:
        if isinstance(m, Rssi):
            assert m.stamp_ns == requests[m.request_seq].stamp_ns
            assert m.rssi_dbm == {10: -70.0, 11: -71.0, 20: -72.0}[m.node_id]
    truth = back.truth[1]
    assert truth.stamps_ns.tolist() == [m.stamp_ns for m in requests]
    assert truth.positions.tolist() == [[1.0 + k, 2.0, 1.8] for k in range(5)]
    assert np.all(np.isnan(truth.velocities))


def test_the_radio_comes_from_the_histograms_alone(tmp_path):
    (bag,) = import_set('danis', flat(tmp_path / 'src'), tmp_path / 'out')
    anchors = read(bag).anchors
    assert anchors.ids.tolist() == [10, 11, 20]
    np.testing.assert_allclose(anchors.positions, [xyz for xyz, _ in RECEIVERS.values()])
    np.testing.assert_allclose(anchors.p1_dbm, P1, atol=0.1)
    np.testing.assert_allclose(anchors.n, EXPONENT, atol=0.02)
    np.testing.assert_allclose(anchors.sigma_db, WITHIN, atol=0.1)  # one packet, not the mean of many


def test_cut_histograms_do_not_bend_the_curve(tmp_path):
    root = flat(tmp_path / 'src')
    devices = read_devices(find(root).devices)
    path = find(root).histograms
    text = path.read_text().splitlines()
    content = json.loads(text[-1].partition(':')[2])
    for point in list(content)[::3]:
        content[point]['aa01'][BEACON] = [0.5, 0.5, *([0.0] * 78)]
    content['(3, 3, 1.85)']['aa01'][BEACON] = [0.0] * 80  # a receiver that heard nothing
    path.write_text('\n'.join([*text[:-1], f'Fingerprints:{json.dumps(content)}']))
    links = read_histograms(path, devices)
    assert np.sum(links[10].complete == 0.0) >= 9
    anchors = calibrated(devices, links)
    np.testing.assert_allclose(anchors.n, EXPONENT, atol=0.02)
    np.testing.assert_allclose(anchors.sigma_db, WITHIN, atol=0.1)


def test_lines_that_cannot_be_used_are_counted_by_reason(tmp_path):
    bad = [
        'hello\n',
        '\n',
        line('soon'),
        line(T0, rssi='loud'),
        line('nan'),
        line(-5),
        line(1e300),
        line(T0, x='nan'),
        line(T0, rssi=127),
        line(T0, mac='ffff'),
        line(T0, beacon='ffff'),
    ]
    (bag,) = import_set('danis', flat(tmp_path / 'src', ''.join(bad) + track()), tmp_path / 'out')
    metadata = read(bag).metadata
    assert metadata['import_dropped'] == (
        'absurd_number 4, absurd_rssi 1, not_a_number 2, too_few_columns 1, unknown_beacon 1, unknown_receiver 1'
    )
    assert metadata['entry_level'] == 'rssi'
    assert metadata['area'] == '0 0 20.66 17.64'
    assert metadata['target_height'] == '1.8'
    assert metadata['configuration'] == 'danis_central'
    assert metadata['period'] == '0.4500'
    assert len(read(bag).messages) == 5 * 5


def test_lines_may_come_in_any_order(tmp_path):
    lines = track().splitlines(keepends=True)
    (straight,) = import_set('danis', flat(tmp_path / 'a'), tmp_path / 'a_bags')
    (mixed,) = import_set('danis', flat(tmp_path / 'b', ''.join(lines[::-1])), tmp_path / 'b_bags')
    assert next(straight.glob('*.mcap')).read_bytes() == next(mixed.glob('*.mcap')).read_bytes()


def test_texts_of_other_systems_hold_the_same(tmp_path):
    def windows(text):
        return b'\xef\xbb\xbf' + text.replace('\n', '\r\n\r\n').encode()

    (bag,) = import_set('danis', flat(tmp_path / 'src'), tmp_path / 'out')
    other = flat(tmp_path / 'other')
    for path in [path for path in other.rglob('*.*') if path.is_file()]:
        text = path.read_text()
        path.with_name(path.name.upper() + '.gz').write_bytes(gzip.compress(windows(text.replace('aa0', 'AA0'))))
        path.unlink()
    (dressed,) = import_set('danis', other, tmp_path / 'dressed')
    assert dressed.name.lower() == bag.name
    assert repr(read(dressed).messages) == repr(read(bag).messages)  # NaN is nothing's equal
    assert np.array_equal(read(dressed).anchors.p1_dbm, read(bag).anchors.p1_dbm)


def test_a_receiver_that_hears_a_packet_twice_keeps_both(tmp_path):
    (bag,) = import_set(
        'danis', flat(tmp_path / 'src', track() + line(f'{T0 + 0.004:.6f}', rssi=-80)), tmp_path / 'out'
    )
    first = [m for m in read(bag).messages if isinstance(m, Rssi) and m.request_seq == 0 and m.node_id == 10]
    assert [(m.seq, m.rssi_dbm) for m in first] == [(0, -70.0), (1, -80.0)]


@pytest.mark.parametrize(
    ('spoil', 'said'),
    [
        (shutil.rmtree, 'does not exist'),
        (lambda root: shutil.rmtree(root / 'trk'), r'no \*_all_sensors.mbd \(looked for \*.dev'),
        (lambda root: shutil.rmtree(root / 'hst'), r'no \*.hst with set_1'),
        (lambda root: (root / 'cnf' / 'tetam.dev').write_text('Dongles:{'), 'JSON is expected'),
        (lambda root: (root / 'cnf' / 'tetam.dev').write_text('Dongles:{}\nBeacons:{}'), '0 receivers'),
        (lambda root: (root / 'cnf' / 'tetam.dev').write_text(dev().replace('sensor10', 'kitchen')), "'kitchen'"),
        (lambda root: (root / 'cnf' / 'tetam.dev').write_text('hello'), 'no receivers as expected'),
        (lambda root: (root / 'trk' / 'short_all_sensors.mbd').write_text('1,2\n'), r'\(too_few_columns 1\)'),
        (lambda root: (root / 'trk' / 'short_all_sensors.mbd').write_text(''), 'the file is empty'),
        (
            lambda root: (root / 'hst' / 'set_1_tetam_multi_rssi.hst').write_text('Bins:[1]\nFingerprints:{}'),
            r'no histogram of receivers \[10, 11, 20\]',
        ),
        (
            lambda root: (root / 'hst' / 'set_1_tetam_multi_rssi.hst').write_text('Bins:3\nFingerprints:[]'),
            'no histograms as expected',
        ),
    ],
)
def test_what_is_missing_is_told_in_one_line(tmp_path, spoil, said):
    root = flat(tmp_path / 'src')
    spoil(root)
    with pytest.raises(TrackingError, match=said) as error:
        import_set('danis', root, tmp_path / 'out')
    assert '\n' not in str(error.value)


def test_existing_bags_are_not_overwritten(tmp_path):
    import_set('danis', flat(tmp_path / 'src'), tmp_path / 'out')
    with pytest.raises(TrackingError, match='exists'):
        import_set('danis', tmp_path / 'src', tmp_path / 'out')


@pytest.fixture(scope='module')
def real_bags(tmp_path_factory):
    return import_set('danis', real_data('danis_ble_tracks'), tmp_path_factory.mktemp('danis'))


def test_every_real_track_is_whole(real_bags):
    for bag in real_bags:
        back = read(bag)
        lines = (real_data('danis_ble_tracks') / 'trk' / f'{bag.name[6:]}_all_sensors.mbd').read_text().count('\n')
        heard = [m for m in back.messages if isinstance(m, Rssi)]
        assert back.metadata['import_dropped'] == 'nothing'
        assert len(heard) == lines
        assert len({(m.node_id, m.seq) for m in heard}) == lines
        assert {m.node_id for m in heard} == set(back.anchors.ids.tolist())
        assert sum(path.stat().st_size for path in bag.iterdir()) < 2_000_000


def test_real_epochs_are_one_period_apart_and_hold_one_packet(real_bags):
    for bag in real_bags:
        back = read(bag)
        stamps = np.array([m.stamp_ns for m in back.messages if isinstance(m, Request)])
        gaps = np.diff(stamps) / 1e9
        assert gaps.min() > 0.44
        assert np.median(gaps) == pytest.approx(float(back.metadata['period']), abs=1e-4)
        ends = [m for m in back.messages if isinstance(m, EpochEnd)]
        assert [m.final for m in ends] == [False] * (len(ends) - 1) + [True]
        heard = np.mean([len(set(end.node_ids)) for end in ends])
        assert 9.0 < heard < 11.5  # each of the 12 receivers misses 10-22 % of the packets
        low, high = back.truth[1].positions.min(axis=0), back.truth[1].positions.max(axis=0)
        assert np.all(low > [0.0, 0.0, 1.5])
        assert np.all(high < [20.66, 17.64, 2.1])


def test_real_radios_are_calibrated_sensibly(real_bags):
    anchors = read(real_bags[0]).anchors
    assert anchors.ids.tolist() == [10, 11, 12, 20, 21, 22, 30, 31, 32, 40, 41, 42]
    assert np.all((anchors.p1_dbm > -70.0) & (anchors.p1_dbm < -50.0))
    assert np.all((anchors.n > 0.8) & (anchors.n < 2.5))
    assert np.all((anchors.sigma_db > 4.0) & (anchors.sigma_db < 7.0))


def test_real_calibration_holds_on_the_tracks(real_bags):
    """On tracks that the fit has not seen, one packet errs by about sigma, body and movement included."""
    scaled = []
    for bag in real_bags:
        back = read(bag)
        place = dict(zip(back.truth[1].stamps_ns.tolist(), back.truth[1].positions, strict=True))
        heard = [m for m in back.messages if isinstance(m, Rssi)]
        rows = back.anchors.rows([m.node_id for m in heard])
        d = np.linalg.norm(np.array([place[m.stamp_ns] for m in heard]) - back.anchors.positions[rows], axis=1)
        expected = back.anchors.p1_dbm[rows] - 10.0 * back.anchors.n[rows] * np.log10(d)
        scaled.append((np.array([m.rssi_dbm for m in heard]) - expected) / back.anchors.sigma_db[rows])
    assert 0.8 < np.std(np.concatenate(scaled)) < 1.6

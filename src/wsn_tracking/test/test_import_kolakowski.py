"""The flat: windows are epochs, radios come from the survey, walls are kept."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from import_cases import BREAKS, FEW, epochs_of, folder, imported, real_data, refused, same_in_any_dress, survives
from kolakowski_cases import ANCHORS, EXPONENT, HEADER, P1, T0, files, row

from wsn_tracking.bags.importing.run import import_set
from wsn_tracking.bags.read import read


def test_a_window_is_an_epoch_and_a_lost_packet_is_no_value(tmp_path):
    back = imported('kolakowski', files(), tmp_path)
    epochs = epochs_of(back)
    assert [request.stamp_ns for request, _, _ in epochs] == [T0, T0 + 333333333, T0 + 666666667]
    heard = [[(m.node_id, m.rssi_dbm) for m in packets] for _, packets, _ in epochs]
    assert heard == [[(1, -50.0), (2, -60.5), (3, -70.25)], [(2, -61.0)], []]
    assert back.truth[1].positions.tolist() == [[1.0, 2.0, 1.3], [1.5, 2.0, 1.3], [2.0, 2.0, 1.3]]
    assert back.truth[1].stamps_ns.tolist() == [request.stamp_ns for request, _, _ in epochs]


def test_the_radio_comes_from_the_survey_alone(tmp_path):
    back = imported('kolakowski', files(), tmp_path)
    np.testing.assert_allclose(back.anchors.positions, list(ANCHORS.values()))
    np.testing.assert_allclose(back.anchors.p1_dbm, P1, atol=0.01)
    np.testing.assert_allclose(back.anchors.n, EXPONENT, atol=0.01)
    assert np.all(back.anchors.sigma_db < 0.1)


def test_the_metadata_tell_the_flat(tmp_path):
    metadata = imported('kolakowski', files(), tmp_path).metadata
    assert metadata['area'] == '0 0 6.5 5.5'
    assert metadata['walls'] == '0 0 6.5 0; 6.5 0 6.5 5.5; 6.5 5.5 0 5.5; 0 5.5 0 0'
    assert metadata['period'] == '0.3333'
    assert (metadata['entry_level'], metadata['target_height']) == ('rssi', '1.3')
    assert (metadata['configuration'], metadata['import_dropped']) == ('kolakowski', 'nothing')


def test_rows_that_cannot_be_used_are_counted_by_reason(tmp_path):
    bad = [
        'hello\n',
        row(3, x='here'),
        row(4, y='nan'),
        row(5, ts='soon'),
        row(6, ts='-1'),
        row(7, ts='1e40'),
        row(8, cells=('loud', '127', '-60')),
        row(0, 9.0),  # the stamp of the first row
    ]
    back = imported('kolakowski', files(row(0) + ''.join(bad)), tmp_path)
    assert back.metadata['import_dropped'] == (
        'absurd_number 1, absurd_rssi 1, absurd_stamp 2, not_a_number 3, repeated_stamp 1, wrong_columns 1'
    )
    epochs = epochs_of(back)
    assert [[m.node_id for m in packets] for _, packets, _ in epochs] == [[1, 2, 3], [3]]


@pytest.mark.parametrize('lost', ['anchors.csv', 'layout.csv', 'calibration_df.csv', 'test_robot_df.csv'])
def test_a_missing_file_is_named(tmp_path, lost):
    refused('kolakowski', {k: v for k, v in files().items() if lost not in k}, tmp_path, f'holds no {lost}')


@pytest.mark.parametrize(
    ('name', 'content', 'said'),
    [
        ('anchors.csv', 'id,x,y\n1,2,3\n', 'no column z'),
        ('anchors.csv', 'id,x,y,z\n', 'lists no anchor'),
        ('anchors.csv', 'id,x,y,z\none,2,3,4\n', r'anchors.csv, line 2: id, x, y, z are expected, found not a number'),
        ('layout.csv', 'x,y\n0,0\n', '1 corners'),
        ('layout.csv', 'x,y\n\n0,0\n1,hello\n2,2\n', 'layout.csv, line 4: x, y are expected'),
        ('calibration/calibration_df.csv', HEADER, 'can be used for a calibration'),
        ('tests/test_robot_df.csv', '', 'no column ts'),
        ('tests/test_robot_df.csv', HEADER, 'the file is empty'),
        ('copy/anchors.csv', 'id,x,y,z\n', 'holds 2 of anchors.csv'),
    ],
)
def test_what_is_wrong_is_told_in_one_line(tmp_path, name, content, said):
    refused('kolakowski', {**files(), name: content}, tmp_path, said)


def test_texts_of_other_systems_hold_the_same(tmp_path):
    same_in_any_dress('kolakowski', files(), tmp_path)


@FEW
@given(breaks=BREAKS)
def test_broken_files_give_a_bag_or_one_line(tmp_path, breaks):
    survives('kolakowski', files(), breaks, tmp_path)


def test_one_file_of_the_flat_is_not_enough(tmp_path):
    source = folder(tmp_path / 'src', files()) / 'tests' / 'test_robot_df.csv'
    with pytest.raises(Exception, match=r'test_robot_df.csv is no anchors.csv: give the folder') as error:
        import_set('kolakowski', source, tmp_path / 'bag')
    assert error.typename == 'TrackingError'


def test_a_source_that_does_not_exist_is_named(tmp_path):
    with pytest.raises(Exception, match='does not exist') as error:
        import_set('kolakowski', tmp_path / 'nowhere', tmp_path / 'bag')
    assert error.typename == 'TrackingError'


def test_an_existing_bag_is_not_overwritten(tmp_path):
    source = folder(tmp_path / 'src', files())
    import_set('kolakowski', source, tmp_path / 'bag')
    with pytest.raises(Exception, match='exists') as error:
        import_set('kolakowski', source, tmp_path / 'bag')
    assert error.typename == 'TrackingError'


def test_the_real_flat_is_whole_and_its_calibration_holds_on_the_track(tmp_path):
    (bag,) = import_set('kolakowski', real_data('kolakowski_flat_ble'), tmp_path / 'bag')
    back = read(bag)
    epochs = epochs_of(back)
    assert len(epochs) == 719
    assert sum(len(packets) for _, packets, _ in epochs) == 6 * 719
    assert back.metadata['import_dropped'] == 'nothing'
    assert back.metadata['walls'].count(';') == 36
    assert np.all((back.anchors.n > 1.2) & (back.anchors.n < 3.5))
    assert np.all((back.anchors.sigma_db > 4.0) & (back.anchors.sigma_db < 9.0))
    places = back.truth[1].positions
    d = np.linalg.norm(places[:, None] - back.anchors.positions, axis=2)
    heard = np.array([[m.rssi_dbm for m in packets] for _, packets, _ in epochs])
    error = heard - back.anchors.p1_dbm + 10.0 * back.anchors.n * np.log10(d)
    assert np.all(np.abs(error.mean(axis=0)) < 4.0)  # the worst is anchor 4, behind walls
    assert 0.8 < np.std(error / back.anchors.sigma_db) < 1.2

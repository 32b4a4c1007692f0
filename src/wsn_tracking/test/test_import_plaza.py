"""The plaza: one range an epoch, odometry left out."""

from __future__ import annotations

import io

import numpy as np
import pytest
from hypothesis import given
from import_cases import BREAKS, FEW, epochs_of, folder, imported, real_data, refused, survives

from wsn_tracking.bags.importing.matlab import read_tables
from wsn_tracking.bags.importing.run import import_set
from wsn_tracking.bags.read import read
from wsn_tracking.sensing.values import Modality

scipy_io = pytest.importorskip('scipy.io')

TL = [[1.0, -60.0, 20.0], [6.0, -30.0, 70.0], [0.0, -30.0, 25.0], [5.0, 2.0, -6.0]]
TD = [[10.0, 2.0, 1.0, 20.5], [10.25, 2.0, 6.0, 30.25], [10.5, 2.0, 0.0, 5.0], [10.75, 2.0, 5.0, 44.0]]
GT = [[9.9 + 0.1 * k, -40.0 + k, 10.0, 0.1] for k in range(11)]


def mat(**tables) -> bytes:
    out = io.BytesIO()
    content = {'TL': TL, 'TD': TD, 'GT': GT, **tables}
    scipy_io.savemat(out, {name: table for name, table in content.items() if table is not None})
    return out.getvalue()


def files(**tables) -> dict[str, bytes]:
    return {'Plaza9_.mat': mat(**tables)}


def test_every_range_is_an_epoch(tmp_path):
    back = imported('plaza', files(), tmp_path)
    epochs = epochs_of(back)
    assert [request.stamp_ns for request, _, _ in epochs] == [10_000_000_000 + k * 250_000_000 for k in range(4)]
    assert [[(m.node_id, m.range) for m in packets] for _, packets, _ in epochs] == [
        [(1, 20.5)],
        [(6, 30.25)],
        [(0, 5.0)],
        [(5, 44.0)],
    ]
    assert all(m.modality == Modality.UWB and np.isnan(m.variance) for _, packets, _ in epochs for m in packets)
    assert back.anchors.ids.tolist() == [0, 1, 5, 6]
    assert back.anchors.positions.tolist() == [[-30, 25, 0], [-60, 20, 0], [2, -6, 0], [-30, 70, 0]]
    assert back.metadata['area'] == '-65 -11 7 75'
    assert back.metadata['period'] == '0.2500'
    assert back.metadata['source'].endswith('Plaza9_.mat')


def test_ranges_of_one_stamp_are_one_epoch(tmp_path):
    back = imported('plaza', files(TD=[*TD, [10.75, 2.0, 1.0, 21.0]]), tmp_path)
    assert [[m.node_id for m in packets] for _, packets, _ in epochs_of(back)] == [[1], [6], [0], [5, 1]]
    assert back.metadata['import_dropped'] == 'nothing'


def test_the_truth_surrounds_every_epoch(tmp_path):
    truth = imported('plaza', files(), tmp_path).truth[1]
    assert truth.stamps_ns[0] == 9_900_000_000
    assert truth.stamps_ns[-1] >= 10_750_000_000
    np.testing.assert_allclose(truth.positions[:3], [[-40, 10, 0], [-39, 10, 0], [-38, 10, 0]])


def test_rows_that_cannot_be_used_are_counted_by_reason(tmp_path):
    bad = [
        [11.0, 2, 9, 20],
        [11.1, 2, np.nan, 20],
        [11.2, 2, 1, -1],
        [11.3, 2, 1, np.nan],
        [11.4, 2, 1, 1e9],
        [np.nan, 2, 1, 20],
        [-5, 2, 1, 20],
        [10.0, 2, 1, 21],
    ]
    back = imported('plaza', files(TD=TD + bad, GT=[*GT, [np.inf, 1, 2, 3], [12, np.nan, 2, 3]]), tmp_path)
    assert back.metadata['import_dropped'] == (
        'absurd_range 3, absurd_stamp 2, repeated_stamp 1, truth_absurd_number 1, truth_absurd_stamp 1, '
        'unknown_beacon 2'
    )
    assert len(epochs_of(back)) == 4


@pytest.mark.parametrize(
    ('tables', 'said'),
    [
        ({'TD': None}, 'no table TD of at least 4 columns'),
        ({'TD': [[1.0, 2.0]]}, 'no table TD of at least 4 columns'),
        ({'GT': 'hello'}, 'no table GT of at least 3 columns'),
        ({'TL': np.zeros((0, 3))}, 'no table TL of at least 3 columns'),
        ({'TL': [[1, np.nan, 3]]}, 'table TL holds no rows'),
        ({'TL': [[-1, 1, 3]]}, 'leave 0..65535'),
        ({'TD': [[1, 2, 99, 4]]}, r'no measurement can be used \(unknown_beacon 1\)'),
    ],
)
def test_what_is_wrong_is_told_in_one_line(tmp_path, tables, said):
    refused('plaza', files(**tables), tmp_path, said)


def test_a_file_that_is_no_mat_is_told_in_one_line(tmp_path):
    refused('plaza', {'Plaza1_.mat': b'hello\nworld'}, tmp_path, 'is no MATLAB file of level 5')
    refused('plaza', {'Plaza1_.mat': mat()[:-60]}, tmp_path, 'is damaged or cut off')
    refused('plaza', {'readme': ''}, tmp_path, r'holds no Plaza\*.mat')


@pytest.mark.parametrize('kind', ['f8', 'f4', 'i2', 'u1', 'i8', '>f8'])
@pytest.mark.parametrize('packed', [True, False])
def test_tables_are_those_that_scipy_reads(tmp_path, kind, packed):
    rng = np.random.default_rng(7)
    content = {
        'a': rng.uniform(0, 100, (5, 3)).astype(kind),
        'empty': np.zeros((0, 2)),
        'name_of_some_length': np.arange(7.0)[None],
        'text': 'hello',
        'cube': np.zeros((2, 2, 2)),
        'struct': {'x': 1.0},
    }
    scipy_io.savemat(tmp_path / 'a.mat', content, do_compression=packed)
    tables = read_tables(tmp_path / 'a.mat')
    assert sorted(tables) == ['a', 'empty', 'name_of_some_length']
    for name, table in tables.items():
        np.testing.assert_array_equal(table, scipy_io.loadmat(tmp_path / 'a.mat')[name])


def test_of_several_plazas_one_is_to_be_named(tmp_path):
    both = {'Plaza1_.mat': mat(), 'Plaza2_.mat': mat()}
    refused('plaza', both, tmp_path, 'Plaza1_.mat, Plaza2_.mat')
    (bag,) = import_set('plaza', folder(tmp_path / 'src', both) / 'Plaza1_.mat', tmp_path / 'one')
    assert read(bag).metadata['source'].endswith('Plaza1_.mat')


@FEW
@given(breaks=BREAKS)
def test_broken_files_give_a_bag_or_one_line(tmp_path, breaks):
    survives('plaza', files(), breaks, tmp_path)


def test_the_real_plaza_has_ranges_that_are_7_percent_long(tmp_path):
    (bag,) = import_set('plaza', real_data('plaza_uwb_ranges'), tmp_path / 'bag')
    back = read(bag)
    epochs = epochs_of(back)
    assert len(epochs) == 1816
    assert back.metadata['import_dropped'] == 'nothing'
    truth = back.truth[1]
    stamps = np.array([request.stamp_ns for request, _, _ in epochs])
    places = np.column_stack([np.interp(stamps, truth.stamps_ns, axis) for axis in truth.positions.T])
    told = [packet for _, (packet,), _ in epochs]
    at = back.anchors.positions[back.anchors.rows([m.node_id for m in told])]
    d = np.linalg.norm(places - at, axis=1)
    slope, offset = np.polyfit(d, [m.range for m in told], 1)
    assert slope == pytest.approx(1.069, abs=0.002)
    assert np.std([m.range for m in told] - slope * d - offset) == pytest.approx(0.56, abs=0.05)
    low, high = truth.positions.min(axis=0), truth.positions.max(axis=0)
    x_min, y_min, x_max, y_max = map(float, back.metadata['area'].split())
    assert (x_min, y_min) < (low[0], low[1])
    assert (x_max, y_max) > (high[0], high[1])

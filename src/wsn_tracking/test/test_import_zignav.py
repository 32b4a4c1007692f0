"""The sink's log: what fixed nodes read of node 1, damaged rows counted."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from import_cases import BREAKS, FEW, epochs_of, folder, imported, real_data, refused, same_in_any_dress, survives

from wsn_tracking.bags.importing.run import import_set
from wsn_tracking.bags.read import read

TICK_S = 1200 / 4199


def row(node, of_1=-55) -> list[str]:
    cells = ['99'] * 8
    for other in range(1, 8):
        if other != node:
            cells[other - 1] = str(-60 - other)
    cells[0] = str(of_1) if node > 1 else '99'
    return cells


def line(tick, **changed) -> str:
    rows = [row(node, -50 - node) for node in range(1, 8)] + [['99'] * 8]
    for name, cells in changed.items():
        rows[int(name[1:]) - 1] = cells
    return f'Time:      {tick}  NODE1: [ {"; ".join(", ".join(cells) for cells in rows)}]\n'


def files(log=None) -> dict[str, str]:
    return {
        'AP_Pixel_Based_Locations.txt': '330;500;Node1;1\n487;1042;Node2;2\n60;60;Node5;5\n',
        'Area_dimension.txt': 'width,height,pixels,equiv_meters\n543,1125,188,2.4384\n',
        'ZigNav_logs_Dec.6.2017.txt': line(10000) + line(10043) if log is None else log,
    }


def test_a_line_is_what_the_fixed_nodes_read_of_node_1(tmp_path):
    back = imported('zignav', files(), tmp_path)
    epochs = epochs_of(back)
    stamps = [round(10000 * TICK_S * 1e9), round(10043 * TICK_S * 1e9)]
    assert [request.stamp_ns for request, _, _ in epochs] == pytest.approx(stamps, abs=1)
    assert [[(m.node_id, m.rssi_dbm) for m in packets] for _, packets, _ in epochs] == [[(2, -52.0), (5, -55.0)]] * 2
    assert back.metadata['import_dropped'] == 'no_position 8'  # nodes 3, 4, 6, 7 of two lines


def test_pixels_become_metres_with_y_upwards(tmp_path):
    back = imported('zignav', files(), tmp_path)
    scale = 2.4384 / 188
    np.testing.assert_allclose(back.anchors.positions[0], [487 * scale, (1125 - 1042) * scale, 0.0])
    np.testing.assert_allclose(back.truth[1].positions, [[330 * scale, (1125 - 500) * scale, 0.0]] * 2)
    assert back.metadata['area'] == '0 0 7.04283 14.5915'
    # the radio of seed 000: nobody calibrated these nodes
    assert back.anchors.p1_dbm.tolist() == [-45.0, -45.0]
    assert back.anchors.n.tolist() == [3.0, 3.0]


def test_damaged_rows_are_counted_by_reason_and_not_used(tmp_path):
    log = (
        line(10000)
        + line(10043, r2=['-61', '99', '-66', '-66', '-66', '80', '39', '103'])
        + line(10086, r5=['-61', 'x', '-66', '-66', '99', '-1', '-1', '99'])
        + line(10129, r2=['99', *row(2)[1:]])
        + line('soon')
        + line('nan')
        + 'NODE1: hello\n'
        + line(10172).replace(';', ',', 1)
        + line(10000)
    )
    back = imported('zignav', files(log), tmp_path)
    assert back.metadata['import_dropped'] == (
        'absurd_number 1, absurd_rssi 3, damaged_row 1, no_position 20, no_record 1, not_a_number 2, '
        'repeated_stamp 1, wrong_columns 1'
    )
    heard = [[m.node_id for m in packets] for _, packets, _ in epochs_of(back)]
    assert heard == [[2, 5], [5], [2], [5]]


def test_of_several_logs_one_can_be_named(tmp_path):
    source = folder(tmp_path / 'src', {**files(), 'ZigNav_logs_2.txt': line(10000)})
    (bag,) = import_set('zignav', source / 'ZigNav_logs_2.txt', tmp_path / 'bag')
    assert len(epochs_of(read(bag))) == 1


@pytest.mark.parametrize(
    ('name', 'content', 'said'),
    [
        ('AP_Pixel_Based_Locations.txt', '487;1042;Node2;2\n60;60;Node5;5\n', r'places nodes \[2, 5\]'),
        ('AP_Pixel_Based_Locations.txt', '487;1042\n', 'txt, line 1: px;py;name;id are expected'),
        ('Area_dimension.txt', 'width\n543,1125,0,2.4384\n', 'tells no width,height,pixels,metres'),
        ('Area_dimension.txt', '', 'tells no width,height,pixels,metres'),
        ('ZigNav_logs_Dec.6.2017.txt', '', 'the file is empty'),
        ('more/ZigNav_logs_2.txt', '', 'holds 2 of ZigNav_logs'),
    ],
)
def test_what_is_wrong_is_told_in_one_line(tmp_path, name, content, said):
    refused('zignav', {**files(), name: content}, tmp_path, said)


def test_texts_of_other_systems_hold_the_same(tmp_path):
    same_in_any_dress('zignav', files(), tmp_path)


@FEW
@given(breaks=BREAKS)
def test_broken_files_give_a_bag_or_one_line(tmp_path, breaks):
    survives('zignav', files(), breaks, tmp_path)


def test_the_real_log_has_five_impossible_values(tmp_path):
    (bag,) = import_set('zignav', real_data('zignav_zigbee_log'), tmp_path / 'bag')
    back = read(bag)
    epochs = epochs_of(back)
    assert len(epochs) == 99
    assert back.anchors.ids.tolist() == [2, 5, 6, 7]
    assert back.metadata['import_dropped'] == 'absurd_rssi 5, damaged_row 2, no_position 197'
    heard = [m for _, packets, _ in epochs for m in packets]
    assert len(heard) == 4 * 99 - 1
    assert all(-75.0 < m.rssi_dbm < -45.0 for m in heard)
    assert (epochs[-1][0].stamp_ns - epochs[0][0].stamp_ns) / 1e9 == pytest.approx(1200.0)
    assert len(np.unique(back.truth[1].positions, axis=0)) == 1

"""The labyrinth: one range an epoch, wheels left out."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from import_cases import BREAKS, FEW, epochs_of, folder, imported, real_data, refused, same_in_any_dress, survives

from wsn_tracking.bags.importing.run import import_set
from wsn_tracking.bags.read import read
from wsn_tracking.errors import TrackingError
from wsn_tracking.sensing.values import Modality

MODULES = {105: (-0.02, -0.01), 107: (-0.02, 2.365), 108: (2.385, 2.36)}


def ranged(t, metres=1.25, module=105, place=None) -> str:
    x, y = MODULES.get(module, (0.0, 0.0)) if place is None else place
    return f'range2 {t} {metres} 0.01 {x} {y} {module} 0 \n'


def files(lines=None) -> dict[str, str]:
    wheels = ''.join(f'odom2diff {t} 0.1 0.2 0 0.16 0.1 0.1 0.1\n' for t in (0.125, 0.25, 0.375))
    told = ranged(0.125) + ranged(0.25, 2.5, 107) + ranged(0.375, 0.875, 108) if lines is None else lines
    return {
        'Indoor_UWB_Input.txt': wheels + told,
        'Indoor_UWB_GT.txt': ''.join(f'point2 {t} {1 + t} 2 0 0 0 0 \n' for t in (0.125, 0.25, 0.375)),
        'Other_Input.txt': 'not ours',
    }


def test_every_range_is_an_epoch(tmp_path):
    back = imported('labyrinth', files(), tmp_path)
    epochs = epochs_of(back)
    assert [request.stamp_ns for request, _, _ in epochs] == [125_000_000, 250_000_000, 375_000_000]
    heard = [[(m.node_id, m.range) for m in packets] for _, packets, _ in epochs]
    assert heard == [[(105, 1.25)], [(107, 2.5)], [(108, 0.875)]]
    # the variance of the file is the same everywhere: what a range is worth is a parameter
    assert all(m.modality == Modality.UWB and np.isnan(m.variance) for _, packets, _ in epochs for m in packets)
    assert {i: tuple(p) for i, p in zip(back.anchors.ids.tolist(), back.anchors.positions.tolist(), strict=True)} == {
        module: (*place, 0.0) for module, place in MODULES.items()
    }
    assert back.truth[1].positions.tolist() == [[1.125, 2, 0], [1.25, 2, 0], [1.375, 2, 0]]
    assert back.metadata['area'] == '-0.02 -0.01 2.385 2.365'
    assert back.metadata['import_dropped'] == 'nothing'


def test_lines_that_cannot_be_used_are_counted_by_reason(tmp_path):
    bad = [
        'hello\n',
        'range2 1\n',
        ranged('soon'),
        ranged('-1'),
        ranged(1.0, 'far'),
        ranged(1.1, 'nan'),
        ranged(1.2, -1),
        ranged(1.3, place=(9.0, 9.0)),
        ranged(0.125),
    ]
    content = files(ranged(0.125) + ''.join(bad))
    back = imported('labyrinth', content, tmp_path)
    assert back.metadata['import_dropped'] == (
        'absurd_number 1, absurd_range 1, absurd_stamp 1, moved_module 1, not_a_number 2, repeated_stamp 1, '
        'too_few_columns 1, unknown_record 1'
    )
    assert len(epochs_of(back)) == 1


def test_ranges_of_one_stamp_are_one_epoch(tmp_path):
    back = imported('labyrinth', files(ranged(0.125) + ranged(0.25, 2.5, 107) + ranged(0.25, 0.875, 108)), tmp_path)
    heard = [[(m.node_id, m.range) for m in packets] for _, packets, _ in epochs_of(back)]
    assert heard == [[(105, 1.25)], [(107, 2.5), (108, 0.875)]]
    assert back.metadata['import_dropped'] == 'nothing'


def test_the_file_of_ranges_finds_its_truth(tmp_path):
    source = folder(tmp_path / 'src', files())
    (bag,) = import_set('labyrinth', source / 'Indoor_UWB_Input.txt', tmp_path / 'bag')
    assert read(bag).truth[1].stamps_ns.size == 3
    with pytest.raises(TrackingError, match=r'Other_Input.txt is no Indoor_UWB_Input.txt: give the folder'):
        import_set('labyrinth', source / 'Other_Input.txt', tmp_path / 'other')


def test_what_is_wrong_is_told_in_one_line(tmp_path):
    refused('labyrinth', {'readme': ''}, tmp_path, 'holds no Indoor_UWB_Input.txt')
    refused('labyrinth', {'Indoor_UWB_Input.txt': ranged(1.0)}, tmp_path, 'holds no Indoor_UWB_GT.txt')
    refused('labyrinth', files('hello\n'), tmp_path, 'no line `range2')
    refused('labyrinth', files(ranged(1.0, -1)), tmp_path, r'no measurement can be used \(absurd_range 1\)')
    refused('labyrinth', files(ranged(1.0, module=-5)), tmp_path, 'leave 0..65535')


def test_texts_of_other_systems_hold_the_same(tmp_path):
    same_in_any_dress('labyrinth', files(), tmp_path)


@FEW
@given(breaks=BREAKS)
def test_broken_files_give_a_bag_or_one_line(tmp_path, breaks):
    survives('labyrinth', files(), breaks, tmp_path)


def test_the_real_labyrinth_is_whole(tmp_path):
    (bag,) = import_set('labyrinth', real_data('labyrinth_uwb'), tmp_path / 'bag')
    back = read(bag)
    epochs = epochs_of(back)
    assert len(epochs) == 233
    assert back.metadata['import_dropped'] == 'nothing'
    assert back.anchors.ids.tolist() == [105, 107, 108, 109]
    assert back.truth[1].stamps_ns.tolist() == [request.stamp_ns for request, _, _ in epochs]
    told = [packet for _, (packet,), _ in epochs]
    at = back.anchors.positions[back.anchors.rows([m.node_id for m in told])]
    error = np.array([m.range for m in told]) - np.linalg.norm(back.truth[1].positions - at, axis=1)
    assert error.mean() == pytest.approx(0.118, abs=0.01)
    assert error.std() == pytest.approx(0.107, abs=0.01)

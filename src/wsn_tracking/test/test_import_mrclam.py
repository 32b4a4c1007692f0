"""The robots: targets in one bag, a picture is an epoch, other robots are no landmarks."""

from __future__ import annotations

import gzip

import numpy as np
import pytest
from hypothesis import given
from import_cases import BREAKS, FEW, epochs_of, imported, real_data, refused, same_in_any_dress, survives

from wsn_tracking.bags.importing.run import import_set
from wsn_tracking.bags.read import read
from wsn_tracking.evaluation.interpolation import truth_at
from wsn_tracking.sensing.values import Modality

BARCODES = {1: 5, 2: 14, 6: 63, 7: 81, 8: 7}
LANDMARKS = {6: (0.5, -4.0), 7: (3.0, 2.5), 8: (1.0, 4.5)}
T0 = 1248446182
HEAD = '# produced by somebody\n# Time [s]    Subject #    range [m]    bearing [rad]\n'


def seen(t, code=63, metres=1.5) -> str:
    return f'{T0 + t:.3f} \t {code} \t {metres} \t 0.032\n'


def files(first=None, second=None) -> dict[str, str | bytes]:
    truth = HEAD + ''.join(f'{T0 + k / 50:.3f} \t {k / 50} \t 1.0 \t -1.7\n' for k in range(101))
    one = seen(0.5) + seen(0.5, 81, 2.5) + seen(0.501, 7, 3.5) + seen(0.75, 63, 1.25)
    return {
        'set/Barcodes.dat': HEAD + ''.join(f'{subject} \t {code}\n' for subject, code in BARCODES.items()),
        'set/Landmark_Groundtruth.dat': HEAD
        + ''.join(f'{node} \t {x} \t {y} \t 0.001 \t 0.001\n' for node, (x, y) in LANDMARKS.items()),
        'set/Robot1_Measurement.dat': HEAD + (one if first is None else first),
        'set/Robot1_Groundtruth.dat.gz': gzip.compress(truth.encode()),
        'set/Robot2_Measurement.dat': HEAD + (seen(1.0, 81, 4.5) if second is None else second),
        'set/Robot2_Groundtruth.dat': truth,
    }


def test_a_picture_is_an_epoch_of_its_robot(tmp_path):
    back = imported('mrclam', files(), tmp_path)
    first, second = epochs_of(back, 1), epochs_of(back, 2)
    assert [request.stamp_ns - T0 * 10**9 for request, _, _ in first] == [500_000_000, 750_000_000]
    assert [[(m.node_id, m.range) for m in packets] for _, packets, _ in first] == [
        [(6, 1.5), (7, 2.5), (8, 3.5)],
        [(6, 1.25)],
    ]
    assert [[(m.node_id, m.range) for m in packets] for _, packets, _ in second] == [[(7, 4.5)]]
    assert all(m.modality == Modality.OTHER and m.seq == k for k, (_, (m, *_), _) in enumerate(first))
    assert back.anchors.ids.tolist() == [6, 7, 8]
    np.testing.assert_allclose(back.anchors.positions, [(*place, 0.0) for place in LANDMARKS.values()])
    assert back.metadata['area'] == '-1.5 -6 5 6.5'
    assert back.metadata['target_height'] == '0'


def test_the_truth_of_every_robot_is_thinned(tmp_path):
    back = imported('mrclam', files(), tmp_path)
    assert sorted(back.truth) == [1, 2]
    for truth in back.truth.values():
        assert np.all(np.diff(truth.stamps_ns) == 100_000_000)
        np.testing.assert_allclose(truth.positions[:, 0], (truth.stamps_ns - T0 * 10**9) / 1e9, atol=1e-9)
        assert np.all(truth.positions[:, 1:] == [1.0, 0.0])


def test_other_robots_and_broken_lines_are_counted_by_reason(tmp_path):
    bad = [
        seen(0.6, 14),  # robot 2
        seen(0.6, 99),
        'hello\n',
        f'{T0} 63 far\n',
        f'{T0} 63 nan\n',
        'soon 63 1\n',
        '-1 63 1\n',
        seen(0.6, metres=-2),
    ]
    content = files(seen(0.5) + ''.join(bad))
    content['set/Robot2_Groundtruth.dat'] += 'x\n1 2 y\n'
    back = imported('mrclam', content, tmp_path)
    assert back.metadata['import_dropped'] == (
        'absurd_number 1, absurd_range 1, absurd_stamp 1, not_a_number 2, robot_seen 1, too_few_columns 1, '
        'truth_not_a_number 1, truth_too_few_columns 1, unknown_barcode 1'
    )
    assert len(epochs_of(back)) == 1


@pytest.mark.parametrize(
    ('name', 'content', 'said'),
    [
        ('Robot1_Measurement.dat', None, 'holds no Robot1_Measurement.dat'),
        ('Barcodes.dat', None, 'Barcodes.dat cannot be read'),
        ('Barcodes.dat', '# none\n\n1 x\n', 'Barcodes.dat, line 3: 2 numbers are expected, found not a number'),
        ('Landmark_Groundtruth.dat', '6 1\n', 'dat, line 1: 3 numbers are expected, found 2'),
        ('Landmark_Groundtruth.dat', '# none\n', 'holds no line of 3 numbers'),
        ('Robot2_Groundtruth.dat', None, 'Robot2_Groundtruth.dat cannot be read'),
        ('Robot1_Groundtruth.dat.gz', b'\x1f\x8bhello', 'Robot1_Groundtruth.dat.gz cannot be read'),
    ],
)
def test_what_is_wrong_is_told_in_one_line(tmp_path, name, content, said):
    kept = {**files(), f'set/{name}': content}
    refused('mrclam', {path: text for path, text in kept.items() if text is not None}, tmp_path, said)


def test_without_any_landmark_in_sight_nothing_is_left(tmp_path):
    refused('mrclam', files(seen(0.5, 14), ''), tmp_path, r'no measurement can be used \(robot_seen 1\)')


def test_texts_of_other_systems_hold_the_same(tmp_path):
    same_in_any_dress('mrclam', files(), tmp_path)


@FEW
@given(breaks=BREAKS)
def test_broken_files_give_a_bag_or_one_line(tmp_path, breaks):
    survives('mrclam', files(), breaks, tmp_path)


def test_the_real_robots_range_landmarks_to_0_3_m(tmp_path):
    (bag,) = import_set('mrclam', real_data('mrclam'), tmp_path / 'bag')
    back = read(bag)
    assert back.anchors.ids.tolist() == list(range(6, 21))
    assert back.metadata['import_dropped'] == 'robot_seen 4206, unknown_barcode 9'
    used = 0
    for robot in range(1, 6):
        epochs = epochs_of(back, robot)
        assert np.diff([request.stamp_ns for request, _, _ in epochs]).min() > 0.1e9  # pictures
        told = [m for _, packets, _ in epochs for m in packets]
        used += len(told)
        known = truth_at(back.truth[robot], np.array([m.stamp_ns for m in told])).positions
        at = back.anchors.positions[back.anchors.rows([m.node_id for m in told])]
        error = np.array([m.range for m in told]) - np.linalg.norm(known - at, axis=1)
        assert 0.05 < np.nanstd(error) < 0.3
        assert abs(np.nanmedian(error)) < 0.05
    lines = sum(
        sum(not line.startswith('#') for line in path.read_text().splitlines() if line.strip())
        for path in real_data('mrclam').rglob('*_Measurement.dat')
    )
    assert used + 4206 + 9 == lines

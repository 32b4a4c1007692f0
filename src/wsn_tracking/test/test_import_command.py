"""The command line of the importers, and that what they name can be tracked."""

from __future__ import annotations

import numpy as np
import pytest
from import_cases import folder

from wsn_tracking import graphs
from wsn_tracking.bags.importing import KINDS
from wsn_tracking.bags.importing.run import ONE, import_set
from wsn_tracking.bags.read import read
from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.sensing.channel import Channel, Quantity, Ranging
from wsn_tracking.sensing.channel_file import save_channel
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.sensing.values import Request

MODULES = {1: (0.0, 0.0), 2: (4.0, 0.0), 3: (4.0, 4.0), 4: (0.0, 4.0)}


def labyrinth(root):
    times = [0.1 * k for k in range(1, 101)]
    told = ''
    for k, t in enumerate(times):
        module = 1 + k % 4
        x, y = MODULES[module]
        told += f'range2 {t:.1f} {((1 + 0.1 * t - x) ** 2 + (2 - y) ** 2) ** 0.5} 0.01 {x} {y} {module} 0\n'
    truth = ''.join(f'point2 {t:.1f} {1 + 0.1 * t} 2 0 0 0 0\n' for t in times)
    return folder(root, {'Indoor_UWB_Input.txt': told, 'Indoor_UWB_GT.txt': truth})


def test_what_is_imported_can_be_evaluated(call, tmp_path):
    made = call('import', 'labyrinth', labyrinth(tmp_path / 'src'), '-o', tmp_path / 'bag')
    assert (made.code, made.out) == (0, f'{tmp_path / "bag"}\n')
    scored = call('evaluate', tmp_path / 'bag', '--json', tmp_path / 'scores.json')
    assert scored.code == 0
    assert 'fused_3' in scored.out


def test_every_kind_has_an_importer_and_a_configuration_that_tracks():
    assert set(KINDS) == {*ONE, 'danis'}
    for kind in ONE:
        level = 'rssi' if kind in ('kolakowski', 'zignav') else 'range'
        metadata = {'configuration': kind, 'area': '0 0 1 1'}
        recording = Recording(make_anchors([1, 2], [(0, 0), (1, 1)]), level, (Request(0, 1, 0),), {}, metadata, {})
        (plan,) = graphs.plans_of(graphs.source_of(kind, recording), recording.anchors, 'random_q')
        assert {values['input'] for values in plan.estimators} == {level}
        assert plan.sensing is None


@pytest.mark.parametrize(
    ('arguments', 'said'),
    [
        (['lias', '.', '--rate', '0', '-o', 'x'], "'0' is no rate"),
        (['lias', '.', '--rate', 'fast', '-o', 'x'], "'fast' is no rate"),
        (['lias', '.', '--rate', 'nan', '-o', 'x'], "'nan' is no rate"),
        (['nothing', '.', '-o', 'x'], 'nothing'),
        (['plaza', '.'], '-o'),
    ],
)
def test_a_wrong_call_says_what_was_expected(call, arguments, said):
    ended = call('import', *arguments)
    assert ended.code == 2
    assert said in ended.err


def test_an_error_is_one_line(call, tmp_path):
    ended = call('import', 'labyrinth', tmp_path, '--rate', 5, '-o', tmp_path / 'bag')
    assert ended.code == 1
    assert ended.err.count('\n') == 1
    assert 'a rate is for lias alone' in ended.err
    with pytest.raises(TrackingError, match="there is no set 'nothing': expected one of danis"):
        import_set('nothing', tmp_path, tmp_path / 'bag')


def test_without_a_channel_ranges_are_taken_as_they_are(tmp_path):
    (bag,) = import_set('labyrinth', labyrinth(tmp_path / 'src'), tmp_path / 'bag')
    back = read(bag)
    assert back.anchors.bias.tolist() == [0.0] * 4
    assert back.anchors.scale.tolist() == [1.0] * 4
    assert 'channel' not in back.metadata


def test_a_channel_replaces_the_radios(tmp_path):
    def known(*values):
        column = np.array(values)
        return Quantity(column, 0.1 * np.ones(column.size), column - 0.2, column + 0.2)

    counts = np.array([9, 9])
    ranging = Ranging(known(0.25, -0.5), known(1.0625, 0.9375), known(0.1, 0.1), counts, counts)
    save_channel(tmp_path / 'radios.yaml', Channel(np.array([2, 4]), None, ranging, None, {'source': 'a test'}))
    source = labyrinth(tmp_path / 'src')
    (bag,) = import_set('labyrinth', source, tmp_path / 'bag', channel=tmp_path / 'radios.yaml')
    back = read(bag)
    assert back.anchors.bias.tolist() == [0.0, 0.25, 0.0, -0.5]
    assert back.anchors.scale.tolist() == [1.0, 1.0625, 1.0, 0.9375]
    assert back.metadata['channel'] == 'radios.yaml'
    with pytest.raises(TrackingError, match='cannot be read'):
        import_set('labyrinth', source, tmp_path / 'other', channel=tmp_path / 'nothing.yaml')

"""What real radio needs: the figures' machinery on small recordings, and the goals on the real ones."""

from __future__ import annotations

import io
import json
from types import SimpleNamespace

import numpy as np
import pytest
from import_cases import folder, real_data
from kolakowski_cases import files as flat
from kolakowski_cases import robot

from wsn_tracking.configuration import load_configuration
from wsn_tracking.errors import TrackingError
from wsn_tracking.studies.real_radio import __main__ as command
from wsn_tracking.studies.real_radio import found_again as again
from wsn_tracking.studies.real_radio import left_out as leaving
from wsn_tracking.studies.real_radio import tables
from wsn_tracking.studies.real_radio.sets import SETS, Sets, find

BEACONS = np.array([[0.0, -30.0, 25.0], [1.0, -60.0, 20.0], [5.0, 2.0, -6.0], [6.0, -30.0, 70.0]])


def plaza() -> bytes:
    """Ranges 7 % too long of a target on a circle, for two minutes."""
    t = np.arange(0.0, 120.0, 0.5)
    place = np.column_stack([-28.0 + 20.0 * np.cos(t / 15.0), 28.0 + 20.0 * np.sin(t / 15.0)])
    beacon = BEACONS[np.arange(t.size) % 4]
    noise = 0.3 * np.random.default_rng(1).standard_normal(t.size)
    ranges = 1.07 * np.hypot(*(place - beacon[:, 1:]).T) + noise
    out = io.BytesIO()
    tables_ = {
        'TL': BEACONS,
        'TD': np.column_stack([t + 10.0, np.full(t.size, 2.0), beacon[:, 0], ranges]),
        'GT': np.column_stack([t + 10.0, place, t]),
    }
    pytest.importorskip('scipy.io').savemat(out, tables_)
    return out.getvalue()


@pytest.fixture(scope='module')
def data(tmp_path_factory):
    root = tmp_path_factory.mktemp('data')
    folder(root / 'meadow', {'Data/Plaza2_.mat': plaza()})
    folder(root / 'flat', flat(robot()))
    return root


@pytest.fixture(scope='module')
def sets(data, tmp_path_factory):
    return Sets(data, tmp_path_factory.mktemp('work'))


def test_a_set_is_found_by_its_marker_wherever_it_lies(data):
    assert find(data, SETS['kolakowski']) == data / 'flat'
    assert find(data, SETS['plaza2']) == data / 'meadow' / 'Data' / 'Plaza2_.mat'
    with pytest.raises(TrackingError, match=r'no folder with \*_all_sensors.mbd in it: fetch danis'):
        find(data, SETS['danis'])


def test_a_set_is_prepared_once(sets):
    assert sets.bags('kolakowski') is sets.bags('kolakowski')


def test_a_calibration_from_the_first_part_is_scored_on_the_rest(sets):
    result = tables.plaza2(sets)
    assert result['scored_from_s'] == 100.0
    assert result['calibrated']['epochs'] == 40
    assert result['calibrated']['rmse_m'] < 0.5
    assert result['uncalibrated']['rmse_m'] > 1.0
    assert result['calibrated']['nees'] < 4.0 < result['uncalibrated']['nees']


def test_every_rung_of_the_ladder_switches_one_thing_on(sets, monkeypatch):
    asked = []
    monkeypatch.setattr(tables, 'central', lambda _bags, _name, settings: asked.append(settings) or {'rmse_m': 1.0})
    result = tables.kolakowski(sets)
    off = [set(settings) & set(tables.OFF) for settings in asked if 'noise.spectral_density' not in settings]
    assert off[:5] == [
        {'noise.velocity_time', 'update.kind', 'robust.dof', 'robust.offset_std', 'update.kappa'},
        {'update.kind', 'robust.dof', 'robust.offset_std', 'update.kappa'},
        {'robust.dof', 'robust.offset_std', 'update.kappa'},
        {'robust.offset_std', 'update.kappa'},
        {'update.kappa'},
    ]
    assert {} in asked
    assert {settings.get('channel') for settings in asked} == {
        None, sets.bags('kolakowski').channel, sets.bags('kolakowski').with_map
    }  # fmt: skip
    assert result['gaussian_ckf']['best_of_densities']['spectral_density'] == min(tables.DENSITIES)


def test_what_is_switched_off_is_on_in_the_configurations():
    for name in ('danis_central', 'kolakowski'):
        values = load_configuration(name).of('estimator_1')
        for switch in ('noise.velocity_time', 'update.kind', 'robust.dof', 'robust.offset_std'):
            assert values[switch] != tables.OFF[switch]


def test_three_estimators_are_told_beside_their_fusion(sets, tmp_path):
    path = tmp_path / 'three.yaml'
    path.write_text(
        '/**:\n  ros__parameters: {input: rssi, noise.kind: acceleration, fusion.feedback: true, peers: [1, 2, 3]}\n'
        '/**/estimator_1:\n  ros__parameters: {nodes: [1, 2]}\n'
    )
    result = tables.of_three(sets.bags('kolakowski'), str(path))
    assert set(result) == {'feedback', 'no_feedback', 'radio_map'}
    for found in result.values():
        assert np.mean(found['local_rmse_m']) == pytest.approx(found['mean_of_the_locals_rmse_m'], rel=1e-3)
        assert 0.0 < found['fused']['rmse_m'] < 5.0
    assert result['feedback'] != result['no_feedback'] != result['radio_map']


def test_every_table_is_of_a_set_with_a_configuration(monkeypatch):
    asked = []

    class Asked:
        def bags(self, name):
            return SETS[name]

    for make in ('of_signal_strengths', 'of_three', 'of_ranges'):
        monkeypatch.setattr(tables, make, lambda found, name: asked.append(load_configuration(name)) or {'set': found})
    for name, table in tables.TABLES.items():
        assert table(Asked())['set'] in SETS.values()
        assert table.__name__ == name
    assert len(asked) == len(tables.TABLES) == 6


def test_the_command_writes_the_tables_that_are_wanted(data, tmp_path, capsys):
    assert command.main([str(data), 'plaza2', '-o', str(tmp_path)]) == 0
    assert capsys.readouterr().out.strip() == str(tmp_path / 'real_radio.json')
    told = json.loads((tmp_path / 'real_radio.json').read_text())
    assert told['command'] == command.COMMAND
    assert set(told['studies']) == {'plaza2'}
    assert told['studies']['plaza2']['what'].endswith('which are not scored.')
    assert str(data) not in json.dumps(told)


@pytest.mark.parametrize(
    ('name', 'said'), [('plaza3', 'there is no study `plaza3`: expected some of danis_central'), ('lias', 'fetch lias')]
)
def test_what_cannot_be_made_is_refused_in_one_line(data, tmp_path, capsys, name, said):
    assert command.main([str(data), name, '-o', str(tmp_path)]) == 1
    assert command.main([str(data / 'nowhere'), '-o', str(tmp_path)]) == 1
    told = capsys.readouterr().err.strip().split('\n')
    assert said in told[-2]
    assert 'is no folder: the one that holds the recordings is expected' in told[-1]


def test_a_track_that_starts_in_the_wrong_corner_is_given_up_for_the_right_place(sets, monkeypatch):
    monkeypatch.setattr(again, 'WRONG_S', (5.0, 18.0))
    bags = sets.bags('kolakowski')
    kept, found = (again.from_wrong_start(bags, 'kolakowski', {'reacquire.odds': odds}) for odds in (0.0, 4.0))
    assert kept['epochs'] == found['epochs'] == 39
    assert found['rmse_m'] < kept['rmse_m']


def test_nothing_is_heard_in_a_gap(sets, monkeypatch):
    """Whatever is done about it, a track without readings is worse after ten seconds than one with them."""
    bags = sets.bags('kolakowski')
    monkeypatch.setattr(again, 'AFTER_S', 0.7)
    monkeypatch.setattr(again, 'EVERY_S', 16.0)
    errors = []
    for gap in (0.0, 12.0):
        monkeypatch.setattr(again, 'GAP_S', gap)
        errors.append(again.after_gaps(bags, 'kolakowski', {})['rmse_m'])
    assert errors[0] < errors[1]


def test_a_track_is_scored_with_what_the_others_would_have_chosen(sets, monkeypatch):
    """Of two tracks each takes what suits the other one."""
    errors = {'a': (1.0, 3.0), 'b': (2.0, 1.0)}
    bags = sets.bags('kolakowski')
    twice = bags._replace(opened=[*bags.opened, *bags.opened])

    def of_tracks(_bags, _name, settings):
        return [{'local_1': SimpleNamespace(rmse_m=error)} for error in errors[settings['tried']]]

    def pool(scores):
        return SimpleNamespace(rmse_m=float(np.sqrt(np.mean([score.rmse_m**2 for score in scores]))))

    monkeypatch.setattr(leaving, 'of_tracks', of_tracks)
    monkeypatch.setattr(leaving, 'pool', pool)
    told = leaving.left_out(twice, 'any', {'c': {}}, {name: {'tried': name} for name in errors}, ('local_1',))
    assert told['c']['local_1'] == {'rmse_m': 2.55, 'least_m': 1.581, 'most_m': 2.236}  # 2 and 3; 2 and 1; 1 and 3


def test_the_settings_that_are_tried_lie_about_the_configured_one():
    names = {'noise.spectral_density': leaving.DENSITIES, 'noise.velocity_time': leaving.TIMES}
    values = load_configuration('danis_central').of('estimator_1')
    for name, tried in {**names, 'robust.offset_std': leaving.OFFSETS}.items():
        assert values[name] == tried[1]
    assert len(leaving.candidates()) == 27


# --- the goals, where the recordings are at hand


@pytest.fixture(scope='module')
def real(tmp_path_factory):
    names = {'danis': 'danis_ble_tracks', 'kolakowski': 'kolakowski_flat_ble'}
    shared = {real_data(name).parent for name in (*names.values(), 'lias_uwb_planar', 'plaza_uwb_ranges')}.pop()
    return Sets(shared, tmp_path_factory.mktemp('real'))


def test_the_ble_tracks_reach_their_goals(real):
    bags = real.bags('danis')
    plain = tables.central(bags, 'danis_central', {})
    assert plain['rmse_m'] <= 2.7
    assert 1.0 < plain['nees'] < 4.0
    mapped = tables.central(bags, 'danis_central', {'channel': bags.with_map})
    assert mapped['rmse_m'] <= 2.0
    assert 1.0 < mapped['nees'] < 4.0
    outputs = tables.pooled(bags, 'danis_three', {})
    assert outputs['fused_1'].rmse_m <= 2.8
    assert outputs['fused_1'].rmse_m < np.mean([outputs[f'local_{i}'].rmse_m for i in (1, 2, 3)])
    assert 1.0 < outputs['fused_1'].nees < 4.0


def test_the_robot_in_the_flat_reaches_its_goal(real):
    found = tables.central(real.bags('kolakowski'), 'kolakowski', {})
    assert found['rmse_m'] <= 1.85
    assert 1.0 < found['nees'] < 4.0


@pytest.mark.parametrize(
    ('name', 'configuration', 'goal'),
    [('lias', 'lias', 0.12), ('plaza2', 'plaza', 0.9), ('labyrinth', 'labyrinth', 0.15)],
)
def test_calibrated_ranges_reach_their_goals(real, name, configuration, goal):
    bags = real.bags(name)
    found = tables.central(bags, configuration, {'channel': bags.channel})
    assert found['rmse_m'] <= goal
    assert 1.0 < found['nees'] < 4.0

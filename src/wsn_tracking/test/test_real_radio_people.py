"""System C on real signal strengths: its tables on a small recording, and its goals on the real ones."""

from __future__ import annotations

import pytest
from import_cases import folder, real_data
from kolakowski_cases import files as flat
from kolakowski_cases import robot

from wsn_tracking.configuration import load_configuration
from wsn_tracking.graphs.parts import Source
from wsn_tracking.graphs.plans import configuration_of
from wsn_tracking.sensing.floor_plan import read_floor_plan
from wsn_tracking.studies.real_radio import people
from wsn_tracking.studies.real_radio.__main__ import TABLES
from wsn_tracking.studies.real_radio.sets import SETS, Sets, find


class OneFlat(Sets):
    """The robot in a flat in the place of every set."""

    def bags(self, name):
        return super().bags('kolakowski')


@pytest.fixture(scope='module')
def sets(tmp_path_factory):
    root = tmp_path_factory.mktemp('data')
    folder(root / 'flat', flat(robot()))
    return OneFlat(root, tmp_path_factory.mktemp('work'))


def test_the_tables_are_among_those_of_the_command():
    assert set(people.TABLES) <= set(TABLES)


def test_every_rung_is_told_of_both_outputs_and_both_channels(sets, monkeypatch):
    monkeypatch.setattr(people, 'SEEDS', (0, 1))
    monkeypatch.setattr(people, 'LADDER', {rung: people.LADDER[rung] for rung in ('as_configured',)})
    result = people.danis_human(sets)
    assert set(result) == {'path_loss', 'radio_map'}
    for rungs in result.values():
        assert set(rungs) == {*people.LADDER, 'seeds'}
        for rung in people.LADDER:
            assert set(rungs[rung]) == set(people.OUTPUTS)
            assert rungs[rung]['human']['epochs'] > 20
        seeds = rungs['seeds']['human']
        assert seeds['least_m'] <= seeds['mean_m'] <= seeds['most_m']


def test_rungs_differ_from_the_configuration():
    values = load_configuration('human_danis').of('human_tracker')
    for rung, settings in people.LADDER.items():
        changed = {name: value for name, value in settings.items() if values.get(name) != value}
        assert bool(changed) is (rung != 'as_configured')
    assert values.items() >= people.candidates()['dof 4, 4.5 dB, offsets 2.5 dB 5 s, step 0.7'].items()


def test_the_carried_beacon_and_the_robot_share_their_figures():
    one, other = (load_configuration(name).of('human_tracker') for name in ('human_danis', 'human_kolakowski'))
    assert one == other


def test_walls_are_those_of_the_recording(sets, monkeypatch):
    asked = []
    monkeypatch.setattr(people, 'of_tracks', lambda _bags, _name, settings: asked.append(settings) or [])
    monkeypatch.setattr(people, 'told', lambda _scores, _titles: {})
    people.kolakowski_human(sets)
    plans = [settings['floor_plan'] for settings in asked if 'floor_plan' in settings]
    assert len(plans) == len(asked) - len(plans) == 3
    assert all(read_floor_plan(plan).contains([1.0, 1.0]) for plan in plans)


@pytest.mark.parametrize(
    ('named', 'chosen'),
    [
        ('danis_central', 'human_danis'),
        ('danis_three', 'human_danis'),
        ('kolakowski', 'human_kolakowski'),
        ('random_q', 'human'),
        ('', 'human'),
        ('human', 'human'),
    ],
)
def test_a_bag_of_a_set_has_the_setting_of_that_set(named, chosen):
    source = Source('bag', 'rssi', (1,), (1,), {'configuration': named} if named else {}, ())
    assert configuration_of('human', source) == chosen


# --- the goals, where the recordings are at hand


@pytest.fixture(scope='module')
def real(tmp_path_factory):
    shared = {real_data(name).parent for name in ('danis_ble_tracks', 'kolakowski_flat_ble')}.pop()
    return Sets(shared, tmp_path_factory.mktemp('real'))


@pytest.mark.parametrize(('radios', 'filtered', 'lagged'), [('channel', 2.3, 2.05), ('with_map', 1.65, 1.45)])
def test_the_carried_beacon_reaches_its_goals(real, radios, filtered, lagged):
    bags = real.bags('danis')
    outputs = people.told(people.of_tracks(bags, 'human_danis', {'channel': getattr(bags, radios)}), list('abcd'))
    assert outputs['human']['rmse_m'] <= filtered
    assert outputs['human_lag']['rmse_m'] <= lagged


def test_the_robot_reaches_its_goal_with_walls_and_without(real):
    bags = real.bags('kolakowski')
    (plan,) = find(real.data, SETS['kolakowski']).rglob('layout.csv')
    for walls in ({}, {'floor_plan': str(plan)}):
        (scores,) = people.of_tracks(bags, 'human_kolakowski', {'channel': bags.channel, **walls})
        assert scores['human'].rmse_m <= 1.65

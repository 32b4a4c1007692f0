"""System D on recorded ranges, where these are at hand: the goals, and what the command writes."""

from __future__ import annotations

import json

import pytest
from import_cases import real_data

from wsn_tracking.studies.real_radio import hybrid
from wsn_tracking.studies.real_radio.sets import Sets


def test_the_labyrinth_is_tracked_once_its_radios_are_calibrated(tmp_path):
    """Bias from the first third, which is not scored."""
    told = hybrid.of_labyrinth(Sets(real_data('labyrinth_uwb').parent, tmp_path).bags('labyrinth'))
    assert told['calibrated']['rmse_m'] <= 0.16
    assert 1.0 < told['calibrated']['nees'] < 4.0
    assert told['two_models']['rmse_m'] <= 0.16
    assert told['uncalibrated']['rmse_m'] > told['calibrated']['rmse_m']


def test_five_robots_at_once_are_tracked_by_ranges_alone_and_found_again(tmp_path):
    """The first half of the recording; all of it is in docs/results/hybrid_real.json."""
    source, whole = hybrid.open_robots(real_data('mrclam').parent, tmp_path)
    middle = (whole.messages[0].stamp_ns + whole.messages[-1].stamp_ns) // 2
    half = whole._replace(messages=tuple(m for m in whole.messages if m.stamp_ns < middle))
    told = hybrid.of_robots(source, half)
    assert sorted(told['robots']) == ['1', '2', '3', '4', '5']
    assert told['mean_of_medians_m'] <= 0.85
    assert told['worst_median_m'] <= 1.2
    for robot in told['robots'].values():
        assert robot['times_found'] >= 5
        assert robot['found_median_m'] < 1.5


def test_the_command_writes_the_tables_that_are_wanted_and_keeps_the_others(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(hybrid, 'of_labyrinth', lambda bags: {'rmse_m': 0.1})
    monkeypatch.setattr(hybrid, 'of_robots', lambda source, recording: {'mean_of_medians_m': 0.5})
    monkeypatch.setattr(hybrid, 'open_robots', lambda data, work: (None, None))
    monkeypatch.setattr(Sets, 'bags', lambda self, name: name)
    for names in (['labyrinth'], ['mrclam']):
        assert hybrid.main([str(tmp_path), *names, '-o', str(tmp_path)]) == 0
    studies = json.loads((tmp_path / 'hybrid_real.json').read_text())['studies']
    assert {name: value for table in studies.values() for name, value in table.items() if name != 'what'} == {
        'rmse_m': 0.1,
        'mean_of_medians_m': 0.5,
    }
    assert capsys.readouterr().out.split() == [str(tmp_path / 'hybrid_real.json')] * 2


@pytest.mark.parametrize(
    ('words', 'said'),
    [(['labyrinth', 'maze'], 'there is no study `maze`'), (['mrclam'], 'Landmark_Groundtruth.dat')],
)
def test_what_cannot_be_made_is_refused_in_one_line(tmp_path, capsys, words, said):
    assert hybrid.main([str(tmp_path), *words, '-o', str(tmp_path / 'out')]) == 1
    told = capsys.readouterr().err.strip().splitlines()[-1]
    assert told.startswith('hybrid: ')
    assert said in told

"""The long runs: their figures, their intervals, and the file that keeps them."""

import json

import numpy as np
import pytest

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.radio import rssi_at
from wsn_tracking.sensing import trigger
from wsn_tracking.simulation.scenarios import scenario
from wsn_tracking.studies import __main__ as studies
from wsn_tracking.studies import loss, random_q, random_q_noise, random_q_triggers, random_q_whole_db
from wsn_tracking.studies import random_q_runs as runs_of
from wsn_tracking.studies.intervals import change_of, mean_of, ratio_of
from wsn_tracking.studies.results import make


def test_intervals_hold_the_truth_as_often_as_they_say():
    rng = np.random.default_rng(1)
    held_mean = held_ratio = held_root = 0
    for _ in range(400):
        below = rng.gamma(4.0, 1.0, 200)
        above = 0.8 * below + 0.3 * rng.standard_normal(200)
        low, high = mean_of(below)['interval_95']
        held_mean += low < 4.0 < high
        low, high = ratio_of(above, below)['interval_95']
        held_ratio += low < 0.8 < high
        low, high = ratio_of(above, below, root=True)['interval_95']
        held_root += low < np.sqrt(0.8) < high
    # 400 draws of 95 %: 380, standard deviation 4.4
    assert all(362 <= held <= 396 for held in (held_mean, held_ratio, held_root))


def test_what_two_quantities_have_in_common_cancels():
    values = np.random.default_rng(2).gamma(2.0, 1.0, 50)
    assert ratio_of(0.9 * values, values) == {'value': 0.9, 'interval_95': [0.9, 0.9]}
    assert mean_of(np.array([1.0, 1.0]), 100.0)['value'] == 100.0
    assert change_of(0.75 * values, values) == {'value': -25.0, 'interval_95': [-25.0, -25.0]}


def test_every_study_of_system_a_runs_and_is_plain_json():
    results = {
        'trigger_rate': random_q.trigger_rate(runs=3),
        'update_forms': random_q.update_forms(runs=3),
        'matched_model': random_q.matched_model(runs=6, epochs=4, reference_runs=3, particles=50),
        'process_noise': random_q_noise.process_noise(runs=3),
        'fusion_rules': random_q_noise.fusion_rules(runs=3, sought_runs=2),
        'data_rate': random_q_triggers.data_rate(runs=4, paths=2),
    }
    assert set(results) == set(studies.STUDIES['system_a'])
    text = json.dumps(results, allow_nan=False)
    assert results == json.loads(text)
    low, high = results['trigger_rate']['sent_of_in_radius']['alpha_0.3']['interval_95']
    assert 0.3 < low < high < 0.5


def test_every_study_of_system_e_runs_and_is_plain_json():
    results = {
        'loss_rate': loss.loss_rate(runs=3, rates=(0.5,)),
        'loss_kind': loss.loss_kind(runs=3, rates=(0.5,)),
    }
    assert set(results) == set(studies.STUDIES['loss_tolerant'])
    assert results == json.loads(json.dumps(results, allow_nan=False))


def test_whole_db_is_plain_json_and_the_trigger_sees_only_what_is_rounded_before_it():
    told = random_q_whole_db.whole_db(runs=4, paths=2)
    assert told == json.loads(json.dumps(told, allow_nan=False))
    event = told['a_loop']['event']
    assert event['behind']['sent_a_run'] == event['exact']['sent_a_run']
    assert event['behind']['ei_cm_document'] != event['exact']['ei_cm_document']
    assert event['before']['sent_a_run'] != event['exact']['sent_a_run']


def test_whole_db_moves_a_signal_by_at_most_half_a_db():
    s = scenario('a_loop')
    sensed = runs_of.sense(s, runs_of.repeated(s, 2), trigger.near(-46.9), np.random.default_rng(1))
    rounded = random_q_whole_db.told_in_whole_db(s, sensed)
    before, after = rssi_at(s.anchors, sensed.z), rssi_at(s.anchors, rounded.z)
    np.testing.assert_array_equal(np.isnan(before), np.isnan(after))
    assert 0.4 < np.nanmax(np.abs(after - before)) <= 0.5 + 1e-9
    np.testing.assert_allclose(after, np.round(after), atol=1e-9)


def counted():
    """One line that says what.

    And more.
    """
    counted.times += 1
    return {'value': counted.times, 'b': 1, 'a': 2}


def other():
    """Another."""
    return {'value': 0}


@pytest.fixture
def table():
    counted.times = 0
    return {'first': {'counted': counted, 'other': other}, 'second': {'third': other}}


def test_every_table_is_a_file_with_sorted_keys(tmp_path, table):
    new = tmp_path / 'new'
    assert make(new, (), table, command='test') == [new / 'first.json', new / 'second.json']
    text = (new / 'first.json').read_text()
    assert text.index('"a"') < text.index('"b"') < text.index('"value"')
    told = json.loads(text)
    assert told['studies']['counted'] == {'what': 'One line that says what.', 'value': 1, 'a': 2, 'b': 1}
    assert str(tmp_path) not in text


def test_a_study_alone_leaves_the_others_figures(tmp_path, table):
    make(tmp_path, (), table, command='test')
    before = (tmp_path / 'second.json').read_bytes()
    assert make(tmp_path, ['other'], table, command='test') == [tmp_path / 'first.json']
    assert json.loads((tmp_path / 'first.json').read_text())['studies']['counted']['value'] == 1
    assert (tmp_path / 'second.json').read_bytes() == before
    make(tmp_path, ['counted'], {'first': {'counted': counted}}, command='test')
    assert set(json.loads((tmp_path / 'first.json').read_text())['studies']) == {'counted'}  # `other` is no more


def test_what_cannot_be_run_or_kept_is_refused_in_one_line(tmp_path, table, capsys):
    with pytest.raises(TrackingError, match='there is no study `tird`: expected some of counted, other, third'):
        make(tmp_path, ['tird'], table, command='test')
    (tmp_path / 'first.json').write_text('[]')
    with pytest.raises(TrackingError, match='holds no figures of a study'):
        make(tmp_path, (), table, command='test')
    assert studies.main(['-o', str(tmp_path), 'nonsense']) == 1
    assert capsys.readouterr().err.startswith('studies: there is no study `nonsense`')


def test_the_command_prints_what_it_wrote(tmp_path, table, monkeypatch, capsys):
    monkeypatch.setattr(studies, 'STUDIES', table)
    assert studies.main(['-o', str(tmp_path)]) == 0
    assert capsys.readouterr().out.split() == [str(tmp_path / 'first.json'), str(tmp_path / 'second.json')]

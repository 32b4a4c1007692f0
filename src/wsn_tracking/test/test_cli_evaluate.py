"""The commands evaluate and plot: tables, the same for machines, pooled, of one target."""

from __future__ import annotations

import json

import numpy as np
import pytest
from cli_cases import EPOCHS
from graph_cases import a_loop

from wsn_tracking.bags.save import save
from wsn_tracking.evaluation.run import summarise
from wsn_tracking.evaluation.summary import pool_summaries
from wsn_tracking.graphs import open_bag
from wsn_tracking.offline import offline


def of_library(bag, **options):
    source, recording = open_bag(str(bag))
    return summarise(source.title, recording, offline(source, recording, **options))


def test_evaluate_prints_a_table_and_writes_the_same_for_machines(call, bags, tmp_path):
    ended = call('evaluate', bags / 'first', '--json', tmp_path / 'scores.json')
    assert (ended.code, ended.err) == (0, '')
    for word in ('first', 'target 1', 'RMSE', 'median', 'p95', 'EI', 'ESI x', 'NEES', 'epochs', 'sent', 'dropped'):
        assert word in ended.out
    told = json.loads((tmp_path / 'scores.json').read_text())
    expected = of_library(bags / 'first')
    assert list(told['outputs']) == list(expected.outputs)
    assert [*told['outputs']] == ['local_1', 'local_2', 'local_3', 'fused_1', 'fused_2', 'fused_3', 'mean', 'lci']
    for name, s in expected.outputs.items():
        row = told['outputs'][name]
        assert {'rmse_m', 'median_m', 'p95_m', 'ei_m', 'nees', 'nees_interval', 'epochs'} <= set(row)
        assert row['rmse_m'] == s.rmse_m
        assert row['epochs'] == EPOCHS - 5
        assert f'{s.rmse_m:.3f}' in ended.out
    assert told['epochs'] == EPOCHS
    assert told['input'] == {}


@pytest.mark.parametrize(
    ('told', 'words', 'height', 'asks'),
    [
        ({}, (), 1.25, True),
        ({}, (), 0.0, False),
        ({}, ('--set', 'target_height=1.25'), 1.25, False),
        ({'target_height': '1.25'}, (), 1.25, False),
    ],
    ids=['unknown', 'on the ground', 'given', 'in the bag'],
)
def test_a_truth_of_a_height_that_nobody_told_is_pointed_out(call, tmp_path, told, words, height, asks):
    flat = a_loop(2)
    metadata = {key: value for key, value in flat.metadata.items() if key != 'target_height'} | told
    truth = {
        target: t._replace(positions=t.positions + np.array([0.0, 0.0, height])) for target, t in flat.truth.items()
    }
    save(tmp_path / 'high', flat._replace(truth=truth, metadata=metadata))
    ended = call('evaluate', tmp_path / 'high', '--skip', '0', *words)
    assert ended.code == 0
    assert ended.err.endswith('try --set target_height=1.25\n') == asks
    assert bool(ended.err) == asks


def test_several_bags_are_pooled(call, bags, tmp_path):
    ended = call('evaluate', bags / 'first', bags / 'second', '--json', tmp_path / 'scores.json')
    assert ended.code == 0
    assert ended.out.count('pooled over 2 bags') == 1
    told = json.loads((tmp_path / 'scores.json').read_text())
    assert [bag['title'] for bag in told['bags']] == ['first', 'second']
    summaries = [of_library(bags / name) for name in ('first', 'second')]
    pooled = pool_summaries(summaries)
    for name, s in pooled.outputs.items():
        assert told['pooled']['outputs'][name]['rmse_m'] == s.rmse_m
        assert told['pooled']['outputs'][name]['epochs'] == 2 * (EPOCHS - 5)
        assert [bag['outputs'][name]['rmse_m'] for bag in told['bags']] == [x.outputs[name].rmse_m for x in summaries]


def test_options_reach_the_trackers(call, bags, tmp_path):
    given = {'trigger.kind': 'near', 'trigger.y_min': -46.9, 'peers': [2]}
    words = [word for name, value in given.items() for word in ('--set', f'{name}={value}')]
    words += ['--skip', '2', '--json', tmp_path / 'scores.json', '--config', 'random_q']
    ended = call('evaluate', bags / 'first', *words)
    assert ended.code == 0
    told = json.loads((tmp_path / 'scores.json').read_text())
    assert list(told['outputs']) == ['local_2', 'fused_2']
    assert told['outputs']['local_2']['epochs'] == EPOCHS - 2
    assert told['measurements']['sent'] == of_library(bags / 'first', settings=given).traffic.sent


def test_a_target_is_chosen_by_its_id(call, bags, tmp_path):
    ended = call('evaluate', bags / 'two_targets', '--skip', 0, '--target', 1, '--json', tmp_path / 'scores.json')
    assert ended.code == 0
    assert json.loads((tmp_path / 'scores.json').read_text())['target_id'] == 1
    ended = call('evaluate', bags / 'two_targets', '--skip', 0, '--target', 4)
    assert ended.code == 1  # only target 1 has a truth
    assert 'no truth/target_<id> of what was tracked' in ended.err


def test_a_bag_of_ranges_is_evaluated_as_well(call, bags):
    ended = call('evaluate', bags / 'ranged')
    assert (ended.code, ended.err) == (0, '')
    assert 'fused_3' in ended.out


def test_without_truth_nothing_is_scored_and_the_code_says_so(call, bags, tmp_path):
    ended = call('evaluate', bags / 'no_truth', '--json', tmp_path / 'scores.json')
    assert ended.code == 1
    assert len(ended.err.splitlines()) == 1
    assert 'no output' in ended.out
    assert json.loads((tmp_path / 'scores.json').read_text())['outputs'] == {}


def test_plots_go_into_a_folder_a_bag(call, bags, tmp_path, monkeypatch):
    drawn = []

    def draw(folder, *_, **__):
        drawn.append(folder)
        return [folder]

    monkeypatch.setattr('wsn_tracking.evaluation.plots.plot_all', draw)
    assert call('evaluate', bags / 'first', '--plot', tmp_path / 'one').code == 0
    assert call('evaluate', bags / 'first', bags / 'no_truth', '--plot', tmp_path / 'two').code == 1
    assert drawn == [tmp_path / 'one', tmp_path / 'two' / 'first', tmp_path / 'two' / 'no_truth']


def test_plot_names_what_it_drew(call, bags, tmp_path, monkeypatch):
    monkeypatch.setattr('wsn_tracking.evaluation.plots.plot_all', lambda folder, *_, **__: [folder / 'map.png'])
    ended = call('plot', bags / 'no_truth', '-o', tmp_path)
    assert (ended.code, ended.out) == (0, f'{tmp_path / "map.png"}\n')
    assert 'there is only the map' in ended.err

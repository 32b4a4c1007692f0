"""The study and the benchmark of system B: what they write, and that they compare equals."""

import json

import numpy as np

from wsn_tracking.benchmarks import consensus as benchmark_consensus
from wsn_tracking.benchmarks.rows import Sizes
from wsn_tracking.studies import consensus, consensus_parts, consensus_scaling


def test_the_study_writes_every_table(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(consensus_scaling, 'SIZES', (10, 25))
    monkeypatch.setattr(consensus_parts, 'DYING', 1)
    monkeypatch.setattr(consensus_parts, 'VARIANTS', [('uniform', 4.0)])
    assert consensus.main(['-o', str(tmp_path), '--runs', '1']) == 0
    content = json.loads((tmp_path / 'consensus.json').read_text())
    assert list(content['tables']) == ['schemes', 'ten_bytes', 'faults', 'links', 'deaths', 'parts', 'scaling']
    rows = {row['name']: row for row in content['tables']['schemes']}
    assert rows['cm, L = 20']['bytes_nominal'] == 1280.0
    assert rows['cm, L = 20']['rmse_of_cm_20'] == 1.0
    assert all(
        row['rmse_m'] > 0.0
        for table in ('schemes', 'ten_bytes', 'faults', 'links', 'parts')
        for row in content['tables'][table]
    )
    assert [row['deaths'] for row in content['tables']['deaths']] == [1] * 4
    text = (tmp_path / 'consensus.md').read_text()
    assert all(f'| {name} |' in text for name in (*rows, '25 nodes', '10 nodes'))
    capsys.readouterr()


def test_a_study_that_cannot_be_written_says_so_in_one_line(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(consensus, 'study', lambda runs: {'schemes': []})
    (tmp_path / 'file').write_text('')
    assert consensus.main(['-o', str(tmp_path / 'file' / 'below')]) == 1
    assert capsys.readouterr().err.count('\n') == 1


def test_the_benchmark_compares_equal_results(monkeypatch):
    graph, x = benchmark_consensus.problem()
    ours, loop = benchmark_consensus.ours(graph, x)(), benchmark_consensus.loop(graph, x)()
    np.testing.assert_allclose(ours, loop, atol=1e-12)
    monkeypatch.setattr(benchmark_consensus, 'RUNS', 2)
    monkeypatch.setattr(benchmark_consensus, 'GROWN', (10,))
    monkeypatch.setattr(benchmark_consensus, 'scenario_b', lambda *_: lambda: None)
    rows = list(benchmark_consensus.rows(Sizes(rounds=1, least=0.0)))
    assert [row.goal is not None for row in rows] == [True, False, False]
    assert all(row.ours >= 0.0 for row in rows)


def test_the_benchmarks_runs_stay_on_the_track():
    state = benchmark_consensus.scenario_b(3, nodes=10, epochs=4)()
    assert state.belief.m.shape == (3, 10, 4)
    assert np.all(np.diagonal(state.belief.P, axis1=-2, axis2=-1)[..., :2] < 1.0)

"""The commands that make bags and tell what they hold."""

from __future__ import annotations

from pathlib import Path

from cli_cases import EPOCHS
from graph_cases import a_loop

from wsn_tracking import processes
from wsn_tracking.bags.read import read
from wsn_tracking.bags.save import save


def test_simulate_writes_a_bag_and_says_so(call, tmp_path):
    ended = call('simulate', 'a_loop', '--seed', 7, '-o', tmp_path / 'seven')
    assert (ended.code, ended.err) == (0, '')
    assert ended.out == f'{tmp_path / "seven"}: a_loop, seed 7, {120 * 14} messages\n'
    assert repr(read(tmp_path / 'seven').messages) == repr(a_loop(120, 7).messages)


def test_simulate_live_records_the_graph_and_writes_it_anew(call, tmp_path, monkeypatch):
    codes = iter([0, 5])
    seen = []

    def run(graph, last):
        recorder = next(p for p in graph if p.name == 'bag_recorder')
        seen.append(recorder.parameters['output'])
        save(recorder.parameters['output'], a_loop(2))
        return next(codes)

    monkeypatch.setattr(processes, 'run_graph', run)
    assert call('simulate', 'a_loop', '--live', '-o', tmp_path / 'live').code == 0
    assert repr(read(tmp_path / 'live').messages) == repr(a_loop(2).messages)
    assert call('simulate', 'a_loop', '--live', '-o', tmp_path / 'failed').code == 5
    assert not (tmp_path / 'failed').exists()
    assert not any(Path(output).exists() for output in seen)


def test_info_says_what_a_bag_holds(call, bags):
    ended = call('info', bags / 'first')
    assert (ended.code, ended.err) == (0, '')
    rows = dict(line.split('  ', 1) for line in ended.out.splitlines())
    assert rows['entry level'].strip() == 'rssi'
    assert f'{EPOCHS} epochs' in rows['target 1'] or f'{EPOCHS} epochs' in ended.out

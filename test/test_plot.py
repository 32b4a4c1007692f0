"""`wsn-tracking plot`: the pictures of `evaluate --plot`, and their paths."""

from __future__ import annotations

import pytest

import live
from wsn_tracking import cli


def ran(*arguments):
    with pytest.raises(SystemExit) as ended:
        cli.main(arguments)
    return ended.value.code


def test_plot_draws_what_evaluate_draws_and_prints_the_paths(tmp_path, capsys):
    setting = ['--set', 'peers=[1]', '--set', 'trigger.kind=near', '--skip', '20']
    assert ran('plot', str(live.A_LOOP), '-o', str(tmp_path / 'a'), *setting) == 0
    told, complaint = capsys.readouterr()
    assert told.splitlines() == [str(tmp_path / 'a' / name) for name in ('map.png', 'error.png', 'nees.png')]
    assert complaint == ''
    assert ran('evaluate', str(live.A_LOOP), '--plot', str(tmp_path / 'b'), *setting) == 0
    for path in sorted((tmp_path / 'a').iterdir()):
        assert path.read_bytes() == (tmp_path / 'b' / path.name).read_bytes()


def test_plot_of_a_bag_without_truth_is_a_map_and_says_so(tmp_path, capsys):
    assert ran('plot', str(live.ROOT / 'bags' / 'broken' / 'no_truth'), '-o', str(tmp_path)) == 0
    told, complaint = capsys.readouterr()
    assert told.splitlines() == [str(tmp_path / 'map.png')]
    assert 'no truth' in complaint
    assert [path.name for path in tmp_path.iterdir()] == ['map.png']


def test_plot_of_no_bag_is_one_line(tmp_path, capsys):
    assert ran('plot', str(tmp_path / 'nothing'), '-o', str(tmp_path / 'plots')) == 1
    assert len(capsys.readouterr().err.strip().splitlines()) == 1
    assert not (tmp_path / 'plots').exists()

"""The command line: what it prints, its exit codes, and that a mistake is answered in one line."""

from __future__ import annotations

import contextlib
import io
import json
import os
import re
import shlex
import sys
from pathlib import Path

import pytest
from graph_cases import a_loop, ranged, with_second_target, without_truth
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from wsn_tracking import cli, processes
from wsn_tracking.bags.read import read
from wsn_tracking.bags.save import save
from wsn_tracking.cli import main
from wsn_tracking.evaluation.run import summarise
from wsn_tracking.evaluation.summary import pool_summaries
from wsn_tracking.graphs import open_bag
from wsn_tracking.offline import offline
from wsn_tracking.sensing.stage import TriggerConfig

EPOCHS = 9
COMMANDS = [module.__name__.rpartition('.')[2].replace('import_data', 'import') for module in cli.COMMANDS]


@pytest.fixture(scope='module')
def bags(tmp_path_factory):
    folder = tmp_path_factory.mktemp('bags')
    save(folder / 'first', a_loop(EPOCHS))
    save(folder / 'second', a_loop(EPOCHS, 3))
    save(folder / 'ranged', ranged(a_loop(EPOCHS), TriggerConfig(kind='near')))
    save(folder / 'no_truth', without_truth(a_loop(2)))
    save(folder / 'two_targets', with_second_target(a_loop(2)))
    return folder


class Called:
    """What a call printed, and its exit code."""

    def __init__(self, capsys, *arguments):
        with pytest.raises(SystemExit) as ended:
            main([str(argument) for argument in arguments])
        self.code = ended.value.code
        self.out, self.err = capsys.readouterr()


@pytest.fixture
def call(capsys):
    return lambda *arguments: Called(capsys, *arguments)


@pytest.fixture
def started(monkeypatch):
    """Instead of starting processes, notes them; `code` is what they end with."""

    class Started:
        code = 0

        def __call__(self, graph, last):
            self.graph, self.last = {p.name: p for p in graph}, list(last)
            return self.code

    noted = Started()
    monkeypatch.setattr(processes, 'run_graph', noted)
    return noted


# ---- help


def test_help_names_every_command(call):
    shown = call('--help')
    assert shown.code == 0
    for command in COMMANDS:
        assert re.search(rf'^    {command}\s', shown.out, re.MULTILINE)


@pytest.mark.parametrize('command', COMMANDS)
def test_help_shows_examples_that_are_right(call, command):
    shown = call(command, '--help')
    assert shown.code == 0
    examples = [line.strip() for line in shown.out.partition('examples:\n')[2].splitlines() if line.strip()]
    assert examples
    for example in examples:
        words = shlex.split(example)
        assert words[:2] == ['wsn-tracking', command]
        assert cli._parser().parse_args(words[1:]).command == command


# ---- mistakes


@pytest.mark.parametrize(
    ('arguments', 'words'),
    [
        ('', 'the following arguments are required: COMMAND'),
        ('dance', "invalid choice: 'dance'"),
        ('simulate no_such -o x', "invalid choice: 'no_such'"),
        ('simulate a_loop', 'required: -o'),
        ('simulate a_loop -o x --seed -1', 'is no seed: expected an integer from 0'),
        ('simulate a_loop -o x --seed 1.5', 'is no seed'),
        ('simulate a_loop -o x --seed ' + '9' * 5000, '--seed'),
        ('evaluate', 'required: BAG'),
        ('evaluate x --skip -1', 'is no time: expected seconds, 0 or more'),
        ('evaluate x --skip nan', 'is no time'),
        ('evaluate x --skip soon', 'is no time'),
        ('evaluate x --target -1', 'is no target: expected an id from 0 to 65535'),
        ('evaluate x --target 65536', 'is no target'),
        ('evaluate x --sett a=b', 'unrecognized arguments'),
        ('replay x --rate 0', 'is no speed: expected a positive multiple of real time, or max'),
        ('replay x --rate fast', 'is no speed'),
        ('replay x --rate inf', 'is no speed'),
        ('replay x y', 'unrecognized arguments: y'),
        ('import nobody x -o y', "invalid choice: 'nobody'"),
    ],
)
def test_a_wrong_call_ends_with_2_and_says_what_was_expected(call, arguments, words):
    ended = call(*arguments.split())
    assert (ended.code, ended.out) == (2, '')
    assert words in ended.err.splitlines()[-1]
    assert ended.err.startswith('usage: wsn-tracking')


@pytest.mark.parametrize(
    ('arguments', 'words'),
    [
        ('evaluate BAGS/none', 'BAGS/none'),
        ('info BAGS/none', 'BAGS/none'),
        ('replay BAGS/none', 'BAGS/none'),
        ('evaluate BAGS', 'BAGS'),
        ('evaluate ' + 'a' * 5000, 'File name too long'),
        ('info BAGS/first/metadata.yaml', 'metadata.yaml'),
        ('info BAGS/first --namespace nowhere', "has nothing in namespace 'nowhere'"),
        ('evaluate BAGS/first --config nowhere', 'no configuration `nowhere`: expected a file or one of'),
        ('evaluate BAGS/first --config ' + 'a' * 5000, 'no configuration'),
        ('evaluate BAGS/first --set trigger.kind', 'expected name=value, e.g. trigger.kind=near'),
        ('evaluate BAGS/first --set trigger.knid=near', 'did you mean `trigger.kind`?'),
        ('evaluate BAGS/first --set trigger.kind=never', "parameter `trigger.kind` is 'never': expected one of event"),
        ('evaluate BAGS/first --set noise.q_max=[', 'no readable YAML'),
        ('evaluate BAGS/first --set a\nb=1', 'there is no parameter `a b`'),
        ('evaluate BAGS/first --set nodes=[77]', 'nodes [77] are not among the anchors'),
        ('evaluate BAGS/first --channel BAGS/none', 'BAGS/none'),
        ('evaluate BAGS/first --target 3', 'first has no target 3: expected one of [1]'),
        ('evaluate BAGS/first --json BAGS/first/metadata.yaml/x', 'cannot be written'),
        ('evaluate BAGS/ranged --set input=rssi', '`input` is rssi, but the bag enters at level range'),
        ('simulate a_loop -o BAGS/first', 'BAGS/first exists: name another folder or remove it'),
        ('simulate a_loop -o /proc/x', '/proc/x cannot be written'),
        ('replay BAGS/first --record BAGS/first', 'BAGS/first exists: name another folder or remove it'),
        ('replay BAGS/first --record /proc/x/y', '/proc/x/y cannot be made'),
        ('import danis BAGS/none -o BAGS/x', 'BAGS/none'),
        ('calibrate BAGS/none -o BAGS/x', 'BAGS/none'),
    ],
)
def test_an_error_is_one_line_and_ends_with_1(call, bags, arguments, words):
    ended = call(*(word.replace('BAGS', str(bags)) for word in arguments.split(' ')))
    assert ended.code == 1
    (line,) = ended.err.splitlines()
    assert line.startswith(f'wsn-tracking {arguments.split()[0]}: error: ')
    assert words.replace('BAGS', str(bags)) in line


def test_whatever_the_system_refuses_is_one_line_too(call, bags, monkeypatch):
    def full(*_):
        raise OSError(28, 'No space left on device')

    monkeypatch.setattr('wsn_tracking.bags.save.save', full)
    ended = call('simulate', 'a_loop', '-o', bags / 'new')
    assert (ended.code, ended.err) == (1, 'wsn-tracking simulate: error: [Errno 28] No space left on device\n')


def test_ctrl_c_ends_with_130(call, bags, monkeypatch):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr('wsn_tracking.bags.save.save', interrupted)
    ended = call('simulate', 'a_loop', '-o', bags / 'new')
    assert (ended.code, ended.out, ended.err) == (130, '', '')


def test_a_reader_that_has_gone_is_no_error_of_ours(call, bags, monkeypatch):
    """As with `| head`: nothing is said, neither now nor when Python ends and writes what is left."""
    reading, writing = os.pipe()
    os.close(reading)
    with os.fdopen(writing, 'w') as broken:
        monkeypatch.setattr(sys, 'stdout', broken)
        ended = call('info', bags / 'first')
    assert (ended.code, ended.err) == (141, '')


def test_a_name_that_the_terminal_cannot_show_is_no_reason_to_fail(call, tmp_path, monkeypatch):
    """A byte that is no UTF-8 in the name of a bag; a terminal that knows no more than ASCII."""
    odd = tmp_path / os.fsdecode(b'odd_\xff')
    save(odd, a_loop(2))
    seen = io.BytesIO()
    monkeypatch.setattr(sys, 'stdout', io.TextIOWrapper(seen, 'ascii'))
    assert call('evaluate', odd, '--set', 'peers=[1]', '--skip', 0).code == 0
    assert seen.getvalue().startswith(rb'odd_\udcff  target 1')


def test_output_may_go_into_memory(bags):
    with pytest.raises(SystemExit), contextlib.redirect_stdout(io.StringIO()) as out:
        main(['info', str(bags / 'first')])
    assert 'rssi' in out.getvalue()


# ---- simulate, info


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


# ---- evaluate


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


def test_a_terminal_sees_progress_and_a_pipe_does_not(call, bags, monkeypatch):
    assert call('evaluate', bags / 'no_truth').err.count('\n') == 1
    monkeypatch.setattr(sys.stderr, 'isatty', lambda: True)
    ended = call('evaluate', bags / 'no_truth', '--set', 'peers=[1]')
    assert 'no_truth' in ended.err
    assert 'local_1' not in ended.err


# ---- replay


def test_replay_starts_the_graph_and_ends_with_its_code(call, bags, started, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    started.code = 3
    ended = call(
        'replay', bags / 'first', '--rate', 'max', '--json', 'scores.json', '--plot', 'plots', '--skip', 2,
        '--record', 'new', '--one-process-each', '--set', 'trigger.kind=near', '--set', 'fusion_timeout=0.5',
    )  # fmt: skip
    assert ended.code == 3
    assert started.last == ['evaluator', 'bag_recorder']
    player, evaluator = started.graph['bag_player'].parameters, started.graph['evaluator'].parameters
    assert (player['bag'], player['rate'], player['progress']) == (str(bags / 'first'), 0.0, False)
    assert (evaluator['json'], evaluator['plot'], evaluator['skip']) == (
        str(tmp_path / 'scores.json'), str(tmp_path / 'plots'), 2.0
    )  # fmt: skip
    assert started.graph['bag_recorder'].parameters['output'] == str(tmp_path / 'new')
    assert started.graph['sensing_7'].parameters['trigger.kind'] == 'near'
    assert started.graph['estimator_2'].parameters['fusion_timeout'] == 0.5


def test_replay_records_only_when_asked_to(call, bags, started):
    assert call('replay', bags / 'first').code == 0
    assert started.last == ['evaluator']
    assert started.graph['bag_player'].parameters['rate'] == 1.0
    assert 'sensing' in started.graph


def test_replay_shows_progress_on_a_terminal(call, bags, started, monkeypatch):
    monkeypatch.setattr(sys.stderr, 'isatty', lambda: True)
    assert call('replay', bags / 'first', '--rate', 20).code == 0
    assert started.graph['bag_player'].parameters['progress'] is True
    assert started.graph['bag_player'].parameters['rate'] == 20.0


# ---- anything at all


OPTIONS = [
    '--json',
    '--set',
    '--target',
    '--skip',
    '--config',
    '--rate',
    '--seed',
    '--record',
    '-o',
    '--namespace',
    '--live',
    '--trackers',
    '--channel',
    '--until',
    '--',
    '-',
    '-h',
    '--one-process-each',
]
WORDS = [
    'BAG',
    'a_loop',
    'danis',
    'max',
    '1',
    '-1',
    'nan',
    '1e400',
    'peers=[1]',
    'peers=',
    'area=[0,0,1,1]',
    'trigger.kind=near',
    'start.epochs=1',
    'noise.q_max=1e308',
    '/',
    '.',
    '..',
    '/dev/null',
    '/dev/zero/x',
]
LETTERS = 'abz019.,=-[]{}:!&*\'"%\\/ \n\t~é漢\U0001f4a9\udcff'
junk = st.one_of(st.text(LETTERS, max_size=12), st.sampled_from(WORDS))
UNHURRIED = [HealthCheck.function_scoped_fixture, HealthCheck.too_slow]


@given(
    st.sampled_from(['evaluate', 'replay', 'info', 'simulate', 'import', 'calibrate']),
    st.booleans(),
    st.lists(st.one_of(junk, st.tuples(st.sampled_from(OPTIONS), junk)), max_size=4),
)
@settings(max_examples=50, suppress_health_check=UNHURRIED)
def test_no_arguments_end_in_a_traceback(bags, started, capsys, tmp_path_factory, command, with_bag, words):
    flat = [word for entry in words for word in ([entry] if isinstance(entry, str) else entry)]
    if with_bag:
        flat.insert(0, 'BAG')
    here = Path.cwd()
    os.chdir(tmp_path_factory.mktemp('run'))
    try:
        ended = Called(capsys, command, *(word.replace('BAG', str(bags / 'no_truth')) for word in flat))
    finally:
        os.chdir(here)
    assert ended.code in {0, 1, 2}
    assert 'Traceback' not in ended.err
    if ended.code:
        assert ended.err

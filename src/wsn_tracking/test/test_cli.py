"""The command line helps, and answers a mistake in one line."""

from __future__ import annotations

import re
import shlex

import pytest

from wsn_tracking import cli

COMMANDS = [name.replace('import_data', 'import') for name in cli.COMMANDS]


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
        ('simulate a_loop -o /proc/x', '/proc/x cannot be made'),
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

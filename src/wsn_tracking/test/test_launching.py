"""Launch files: arguments become a graph; what is wrong is said before anything starts."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest
from graph_cases import a_loop, with_second_target

from wsn_tracking import graphs
from wsn_tracking.bags.save import save
from wsn_tracking.errors import TrackingError
from wsn_tracking.launching import arguments_of, flag, graph_of, rate_of

LAUNCH = sorted((Path(__file__).parents[1] / 'launch').glob('*.launch.py'))
DEFAULTS = {name: value for name, (value, _) in arguments_of('d_stop').items()}


def started(trackers, **given):
    return {p.name: p for p in graph_of(trackers, {**DEFAULTS, **given})}


def test_every_system_has_a_launch_file_and_all_have_one():
    names = {path.name.removesuffix('.launch.py') for path in LAUNCH}
    assert {*graphs.SYSTEMS, 'everything', 'replay', 'serial_bridge', 'follower'} == names


@pytest.mark.parametrize('path', LAUNCH, ids=lambda path: path.name.removesuffix('.launch.py'))
def test_a_launch_file_can_be_loaded_and_shows_how_it_is_used(path):
    content = runpy.run_path(str(path))
    assert callable(content['generate_launch_description'])
    assert f'ros2 launch wsn_tracking {path.name}' in content['__doc__']


@pytest.mark.parametrize('path', LAUNCH, ids=lambda path: path.name.removesuffix('.launch.py'))
def test_a_launch_file_declares_its_arguments_where_launch_is_installed(path):
    installed_launch()
    description = runpy.run_path(str(path))['generate_launch_description']()
    declared = {argument.name for argument in description.get_launch_arguments()}
    assert {'config', 'markers', 'namespace'} <= declared


def installed_launch():
    """ROS 2's `launch`, which the wheels have not: only a full installation does.

    Skipped elsewhere; the graphs that launch files start are tested without it (test_graphs*.py). A package of that
    name that is not ROS 2's, or our own folder of launch files, is another thing.
    """
    launch = pytest.importorskip('launch')
    if not hasattr(launch, 'LaunchService'):
        pytest.skip('another `launch` than that of ROS 2, e.g. the folder of our launch files')
    return launch


def actions_of(path, *given):
    """What a launch file would do with arguments, where launch is installed."""
    context = installed_launch().LaunchContext(argv=[])
    context.launch_configurations.update(entry.split(':=') for entry in given)
    entities = runpy.run_path(str(path))['generate_launch_description']().entities
    return [action for entity in entities for action in entity.visit(context) or ()]


@pytest.mark.parametrize('path', LAUNCH, ids=lambda path: path.name.removesuffix('.launch.py'))
def test_a_place_where_nothing_can_be_recorded_is_refused_before_anything_starts(path, tmp_path):
    """The recorder would end at once, and the feed wait for it."""
    with pytest.raises(TrackingError, match='exists: name another folder or remove it'):
        actions_of(path, f'record:={tmp_path}', 'bag:=none')


def test_without_a_bag_the_scenario_is_simulated():
    processes = started('hybrid', seed='3', rate='max', settings='rest=1.0', parameters='form=imm stale=2.0')
    assert set(processes) == {'world', 'hybrid_tracker', 'evaluator'}
    world = processes['world'].parameters
    assert (world['scenario'], world['seed'], world['rate'], world['settings']) == ('d_stop', 3, 0.0, ['rest=1.0'])
    assert processes['hybrid_tracker'].parameters['form'] == 'imm'
    assert processes['hybrid_tracker'].parameters['stale'] == 2.0


def test_a_bag_is_played_where_there_is_one(tmp_path, monkeypatch):
    save(tmp_path / 'bag', with_second_target(a_loop(3)))
    monkeypatch.chdir(tmp_path)
    processes = started('random_q,hybrid', bag='bag', target='4', record='copy', markers='True', one_process_each='1')
    assert processes['bag_player'].parameters['target_id'] == 4
    assert processes['bag_recorder'].parameters['output'] == str(tmp_path / 'copy')
    assert {'markers', 'sensing_1', 'sensing_12', 'hybrid_tracker', 'estimator_3'} <= set(processes)


@pytest.mark.parametrize(
    ('given', 'words'),
    [
        ({'rate': 'fast'}, 'argument rate:=fast: expected a positive multiple'),
        ({'rate': '-1'}, 'argument rate:=-1'),
        ({'rate': 'nan'}, 'argument rate:=nan'),
        ({'seed': 'x'}, 'argument seed:=x: expected an integer'),
        ({'markers': 'yes'}, 'argument markers:=yes: expected true or false'),
        ({'parameters': 'form'}, 'expected name=value'),
        ({'parameters': 'form=fast'}, "parameter `form` is 'fast': expected one of inflate"),
        ({'settings': 'drop=0.3'}, 'scenario `d_stop` has no parameter `drop`'),
        ({'scenario': 'd_stopp'}, 'there is no scenario `d_stopp`'),
        ({'bag': 'no_such_bag'}, 'no_such_bag'),
    ],
)
def test_a_wrong_argument_is_refused(given, words):
    with pytest.raises(TrackingError) as error:
        started('hybrid', **given)
    assert words in str(error.value)


def test_speeds_and_switches_are_read_as_people_write_them():
    assert (rate_of('max'), rate_of('2'), rate_of('0.5')) == (0.0, 2.0, 0.5)
    assert [flag('x', word) for word in ('true', 'True', '1', 'false', 'False', '0')] == [True] * 3 + [False] * 3

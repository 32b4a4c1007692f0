"""A graph as ROS 2 launch actions; only launch files import this, `launch` is not needed elsewhere."""

from __future__ import annotations

import atexit
import tempfile
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from wsn_tracking import graphs
from wsn_tracking.configuration import parse_setting
from wsn_tracking.errors import TrackingError
from wsn_tracking.files import check_new_folder
from wsn_tracking.graphs import Process
from wsn_tracking.processes import FAREWELL, FEEDS, write_parameters

Arguments = Mapping[str, tuple[str | None, str]]  # name -> default (None: it must be given), words


def actions(processes: Sequence[Process], namespace: str, last: str) -> list[Any]:
    """A node for each process; the launch ends when process `last` has ended, or soon after a feed has failed."""
    from launch.actions import EmitEvent, RegisterEventHandler, TimerAction
    from launch.event_handlers import OnProcessExit
    from launch.events import Shutdown
    from launch_ros.actions import Node

    folder = tempfile.TemporaryDirectory(prefix='wsn_tracking_')
    atexit.register(folder.cleanup)  # no sooner: a node reads its file whenever it gets so far
    nodes = {
        process.name: Node(
            package='wsn_tracking',
            executable=process.executable,
            name=process.name,
            namespace=namespace,
            parameters=[str(write_parameters(process, Path(folder.name)))],
            output='screen',
        )
        for process in processes
    }

    def end(reason: str) -> Any:
        return EmitEvent(event=Shutdown(reason=reason))

    def failed(event: Any, _: Any) -> Any:
        words = f'{event.process_name} has failed'  # nothing will come any more: whoever waits for it gets a grace
        return TimerAction(period=FAREWELL, actions=[end(words)]) if event.returncode else None

    ends = dict.fromkeys(FEEDS, failed) | {last: [end(f'{last} has ended')]}
    known = {name: then for name, then in ends.items() if name in nodes}
    handlers = [OnProcessExit(target_action=nodes[name], on_exit=then) for name, then in known.items()]
    return [*map(RegisterEventHandler, handlers), *nodes.values()]


def description(
    arguments: Arguments, graph: Callable[[Mapping[str, str]], Sequence[Process]], last: str = 'evaluator'
) -> Any:
    """A launch file's description: its arguments, and their graph, which ends when process `last` has ended."""
    from launch.actions import DeclareLaunchArgument, OpaqueFunction
    from launch.substitutions import LaunchConfiguration

    from launch import LaunchDescription  # type: ignore[attr-defined] # mypy sees our folder of that name

    def started(context: Any) -> list[Any]:
        given = {name: LaunchConfiguration(name).perform(context) for name in arguments}
        if given.get('record'):
            check_new_folder(given['record'])  # a recorder that is refused would be waited for
        return actions(graph(given), given.get('namespace', ''), last)

    declared = [
        DeclareLaunchArgument(name, description=words, **({} if value is None else {'default_value': value}))
        for name, (value, words) in arguments.items()
    ]
    return LaunchDescription([*declared, OpaqueFunction(function=started)])


def tracking(trackers: str, scenario: str) -> Any:
    """The description of a launch file that has these trackers on a bag, or on a simulated world."""
    return description(arguments_of(scenario), partial(graph_of, trackers))


def arguments_of(scenario: str) -> Arguments:
    """Arguments of a launch file that simulates this scenario where no bag is named."""
    return {
        'bag': ('', 'rosbag2 folder or .mcap file; empty: a simulated world'),
        'scenario': (scenario, 'experiment to simulate'),
        'seed': ('0', 'of what the nodes read'),
        'settings': ('', 'of the scenario: name=value each, spaces between them, none within'),
        'parameters': ('', 'of the nodes, alike'),
        'target': ('-1', 'the target of the bag that is tracked; -1: what the tracker takes by default'),
        'rate': ('1.0', 'multiple of real time, or max'),
        'config': ('', 'parameter file or name of a configuration; empty: that of the feed'),
        'record': ('', 'folder for a bag of what is sent; empty: none'),
        'one_process_each': ('false', 'a process for every node that may share one'),
        'markers': ('false', 'publish markers for RViz and Foxglove'),
        'namespace': ('', 'namespace of the whole graph'),
    }


def graph_of(trackers: str, given: Mapping[str, str]) -> tuple[Process, ...]:
    """The graph that the arguments ask for; TrackingError where one is wrong."""
    common: dict[str, Any] = {
        'rate': rate_of(given['rate']),
        'trackers': trackers,
        'configuration': given['config'],
        'settings': dict(map(parse_setting, given['parameters'].split())),
        'one_process_each': flag('one_process_each', given['one_process_each']),
        'markers': flag('markers', given['markers']),
    }
    if given['bag']:
        record = {'output': str(Path(given['record']).resolve())} if given['record'] else None
        return graphs.replay(given['bag'], target_id=integer('target', given['target']), record=record, **common)
    return graphs.simulation(
        given['scenario'],
        integer('seed', given['seed']),
        scenario_settings=given['settings'].split(),
        record=given['record'],
        **common,
    )


def rate_of(text: str) -> float:
    """A multiple of real time; `max` is 0, which sets none."""
    try:
        value = 0.0 if text == 'max' else float(text)
    except ValueError:
        value = -1.0
    if not 0.0 <= value <= 1e6:
        raise TrackingError(f'argument rate:={text}: expected a positive multiple of real time, or max')
    return value


def flag(name: str, text: str) -> bool:
    """True or false, as launch files write it."""
    if text.lower() not in {'true', 'false', '1', '0'}:
        raise TrackingError(f'argument {name}:={text}: expected true or false')
    return text.lower() in {'true', '1'}


def integer(name: str, text: str) -> int:
    """A whole number."""
    try:
        return int(text)
    except ValueError:
        raise TrackingError(f'argument {name}:={text}: expected an integer') from None

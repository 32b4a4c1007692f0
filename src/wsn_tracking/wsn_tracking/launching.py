"""A graph as ROS 2 launch actions; only launch files import this, `launch` is not needed elsewhere."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from wsn_tracking.graphs import Process
from wsn_tracking.processes import declared


def actions(processes: Sequence[Process], namespace: str = '', last: str = 'evaluator') -> list[Any]:
    """A node for each process; the launch ends when process `last` has ended."""
    from launch.actions import EmitEvent, RegisterEventHandler
    from launch.event_handlers import OnProcessExit
    from launch.events import Shutdown
    from launch_ros.actions import Node

    nodes = {}
    for process in processes:
        values = {name: _plain(value) for name, value in declared(process).items()}
        nodes[process.name] = Node(
            package='wsn_tracking',
            executable=process.executable,
            name=process.name,
            namespace=namespace,
            parameters=[{name: value for name, value in values.items() if value != []}],
            output='screen',
        )
    ends: list[Any] = []
    if last in nodes:
        shutdown = [EmitEvent(event=Shutdown(reason=f'{last} has ended'))]
        ends = [RegisterEventHandler(OnProcessExit(target_action=nodes[last], on_exit=shutdown))]
    return [*ends, *nodes.values()]


def description(
    arguments: Mapping[str, tuple[str | None, str]], graph: Callable[[Mapping[str, str]], Sequence[Process]]
) -> Any:
    """A launch file's description: arguments by name (default, None: it must be given; words), and their graph."""
    from launch.actions import DeclareLaunchArgument, OpaqueFunction
    from launch.substitutions import LaunchConfiguration

    from launch import LaunchDescription  # type: ignore[attr-defined] # mypy sees our folder of that name

    def started(context: Any) -> list[Any]:
        given = {name: LaunchConfiguration(name).perform(context) for name in arguments}
        return actions(graph(given), given.get('namespace', ''))

    declared = [
        DeclareLaunchArgument(name, description=words, **({} if value is None else {'default_value': value}))
        for name, (value, words) in arguments.items()
    ]
    return LaunchDescription([*declared, OpaqueFunction(function=started)])


def _plain(value: Any) -> Any:
    return list(value) if isinstance(value, tuple) else value

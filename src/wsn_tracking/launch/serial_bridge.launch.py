"""A sink on a serial line, and system A on what its nodes hear.

ros2 launch wsn_tracking serial_bridge.launch.py port:=/dev/serial/by-id/usb-Texas_Instruments_CC2531...
"""

from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration

from launch import LaunchDescription
from wsn_tracking import graphs
from wsn_tracking.launching import actions


def _graph(context):
    argument = {name: LaunchConfiguration(name).perform(context) for name in ARGUMENTS}
    processes = graphs.serial(
        argument['config'],
        settings={'port': argument['port']} if argument['port'] else {},
        record=argument['record'],
        markers=argument['markers'] == 'true',
    )
    return actions(processes, argument['namespace'])


ARGUMENTS = {
    'port': ('', 'serial port; empty: that of the configuration'),
    'config': ('serial_bridge', 'parameter file or name of a configuration'),
    'record': ('', 'folder for a bag of what the sink delivers; empty: none'),
    'markers': ('false', 'publish markers for RViz and Foxglove'),
    'namespace': ('', 'namespace of the whole graph'),
}


def generate_launch_description():
    declared = [
        DeclareLaunchArgument(name, default_value=value, description=words)
        for name, (value, words) in ARGUMENTS.items()
    ]
    return LaunchDescription([*declared, OpaqueFunction(function=_graph)])

"""A sink on a serial line, and system A on what its nodes hear.

ros2 launch wsn_tracking serial_bridge.launch.py port:=/dev/serial/by-id/usb-Texas_Instruments_CC2531...
"""

from wsn_tracking import graphs
from wsn_tracking.launching import description, flag


def _graph(argument):
    return graphs.serial(
        argument['config'],
        settings={'port': argument['port']} if argument['port'] else {},
        record=argument['record'],
        markers=flag('markers', argument['markers']),
    )


ARGUMENTS = {
    'port': ('', 'serial port; empty: that of the configuration'),
    'config': ('serial_bridge', 'parameter file or name of a configuration'),
    'record': ('', 'folder for a bag of what the sink delivers; empty: none'),
    'markers': ('false', 'publish markers for RViz and Foxglove'),
    'namespace': ('', 'namespace of the whole graph'),
}


def generate_launch_description():
    return description(ARGUMENTS, _graph)

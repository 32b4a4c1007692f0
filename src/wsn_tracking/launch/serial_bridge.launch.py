"""A sink on a serial line, and the systems that track on what its nodes report.

ros2 launch wsn_tracking serial_bridge.launch.py port:=/dev/serial/by-id/usb-Texas_Instruments_CC2531...
ros2 launch wsn_tracking serial_bridge.launch.py config:=my_field.yaml trackers:=random_q,loss_tolerant
ros2 launch wsn_tracking serial_bridge.launch.py level:=range trackers:=hybrid parameters:='period=0.1 form=imm'
"""

from wsn_tracking import graphs
from wsn_tracking.configuration import parse_setting
from wsn_tracking.launching import description, flag


def _graph(argument):
    port = {'port': argument['port']} if argument['port'] else {}
    return graphs.serial(
        argument['config'],
        trackers=argument['trackers'],
        level=argument['level'],
        settings={**port, **dict(map(parse_setting, argument['parameters'].split()))},
        record=argument['record'],
        markers=flag('markers', argument['markers']),
    )


ARGUMENTS = {
    'port': ('', 'serial port; empty: that of the configuration'),
    'config': ('serial_bridge', 'parameter file or name of a configuration'),
    'trackers': ('random_q', 'systems, a comma between them, or all'),
    'level': ('rssi', 'what the nodes report: rssi, or range'),
    'parameters': ('', 'of the nodes: name=value each, spaces between them, none within'),
    'record': ('', 'folder for a bag of what the sink delivers; empty: none'),
    'markers': ('false', 'publish markers for RViz and Foxglove'),
    'namespace': ('', 'namespace of the whole graph'),
}


def generate_launch_description():
    return description(ARGUMENTS, _graph)

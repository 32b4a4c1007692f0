"""Two robots in phase: simulated sink, bridge and hybrid tracker in a ring; the second drives by the feedback.

ros2 launch wsn_tracking follower.launch.py
ros2 launch wsn_tracking follower.launch.py markers:=true record:=in_phase parameters:='driven.behind=-1.0'
"""

from wsn_tracking import graphs
from wsn_tracking.configuration import parse_setting
from wsn_tracking.launching import description, flag, integer


def _graph(argument):
    return graphs.follower(
        argument['link'],
        seed=integer('seed', argument['seed']),
        configuration=argument['config'],
        settings=dict(map(parse_setting, argument['parameters'].split())),
        record=argument['record'],
        markers=flag('markers', argument['markers']),
    )


ARGUMENTS = {
    'link': ('wsn_sink', 'symbolic link to the port of the simulated sink'),
    'seed': ('1', 'of the ranges and the radio'),
    'parameters': ('', 'of the nodes: name=value each, spaces between them, none within'),
    'config': ('hybrid', 'parameter file or name of a configuration'),
    'record': ('', 'folder for a bag with ranges, truth and estimates; empty: none'),
    'markers': ('false', 'publish markers for RViz and Foxglove'),
    'namespace': ('', 'namespace of the whole graph'),
}


def generate_launch_description():
    return description(ARGUMENTS, _graph, last='sink_simulator')

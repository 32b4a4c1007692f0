"""System B: nodes that agree with their neighbours, on a simulated field or on a bag.

ros2 launch wsn_tracking consensus.launch.py seed:=1
ros2 launch wsn_tracking consensus.launch.py bag:=bags/b_field rate:=max
ros2 launch wsn_tracking consensus.launch.py settings:='faults=clutter dead=[7,9]' parameters:='link.loss=0.3'
"""

from wsn_tracking import graphs
from wsn_tracking.configuration import parse_setting
from wsn_tracking.launching import description


def _graph(argument):
    common = {
        'rate': 0.0 if argument['rate'] == 'max' else float(argument['rate']),
        'trackers': 'consensus',
        'configuration': argument['config'],
        'settings': dict(map(parse_setting, argument['parameters'].split())),
        'one_process_each': argument['one_process_each'] == 'true',
        'markers': argument['markers'] == 'true',
    }
    if argument['bag']:
        processes = graphs.replay(argument['bag'], **common)
    else:
        processes = graphs.simulation(
            argument['scenario'],
            int(argument['seed']),
            scenario_settings=argument['settings'].split(),
            record=argument['record'],
            **common,
        )
    return processes


ARGUMENTS = {
    'bag': ('', 'rosbag2 folder or .mcap file; empty: a simulated world'),
    'scenario': ('b_field', 'experiment to simulate'),
    'seed': ('0', 'of what the nodes read'),
    'settings': ('', 'of the scenario: name=value each, spaces between them, none within'),
    'parameters': ('', 'of the nodes, alike, e.g. link.loss=0.3 scheme=icf'),
    'rate': ('1.0', 'multiple of real time, or max'),
    'config': ('', 'parameter file or name of a configuration; empty: that of the feed'),
    'record': ('', 'folder for a bag of what the world sends; empty: none'),
    'one_process_each': ('false', 'a process for every node'),
    'markers': ('false', 'publish markers for RViz and Foxglove'),
    'namespace': ('', 'namespace of the whole graph'),
}


def generate_launch_description():
    return description(ARGUMENTS, _graph)

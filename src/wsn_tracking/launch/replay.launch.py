"""Play a bag through the live graph of system A and print the table at its end.

ros2 launch wsn_tracking replay.launch.py bag:=bags/a_loop rate:=max
"""

from wsn_tracking import graphs
from wsn_tracking.launching import description


def _graph(argument):
    return graphs.replay(
        argument['bag'],
        rate=0.0 if argument['rate'] == 'max' else float(argument['rate']),
        configuration=argument['config'],
        one_process_each=argument['one_process_each'] == 'true',
        markers=argument['markers'] == 'true',
    )


ARGUMENTS = {
    'bag': (None, 'rosbag2 folder or .mcap file'),
    'rate': ('1.0', 'multiple of real time, or max'),
    'config': ('', 'parameter file or name of a configuration; empty: what the bag names'),
    'one_process_each': ('false', 'a process for every sensing node'),
    'markers': ('false', 'publish markers for RViz and Foxglove'),
    'namespace': ('', 'namespace of the whole graph'),
}


def generate_launch_description():
    return description(ARGUMENTS, _graph)

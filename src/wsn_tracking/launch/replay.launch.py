"""Play a bag through the live graph of the system that it is for, and print the table at its end.

ros2 launch wsn_tracking replay.launch.py bag:=bags/a_loop rate:=max
ros2 launch wsn_tracking replay.launch.py bag:=bags/d_phase trackers:=hybrid,loss_tolerant
"""

from wsn_tracking.launching import arguments_of, description, graph_of


def _graph(argument):
    return graph_of(argument['trackers'], argument)


def _arguments():
    known = {name: given for name, given in arguments_of('').items() if name not in {'scenario', 'seed', 'settings'}}
    trackers = ('', 'systems, a comma between them, or all; empty: as the bag asks')
    return {**known, 'bag': (None, 'rosbag2 folder or .mcap file'), 'trackers': trackers}


def generate_launch_description():
    return description(_arguments(), _graph)

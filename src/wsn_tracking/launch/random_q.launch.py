"""A simulated world, twelve sensing nodes, three estimators and the evaluator: system A, live.

ros2 launch wsn_tracking random_q.launch.py scenario:=a_loop seed:=1 rate:=5.0
"""

from wsn_tracking import graphs
from wsn_tracking.launching import description


def _graph(argument):
    return graphs.simulation(
        argument['scenario'],
        int(argument['seed']),
        rate=0.0 if argument['rate'] == 'max' else float(argument['rate']),
        configuration=argument['config'],
        record=argument['record'],
        one_process_each=argument['one_process_each'] == 'true',
        markers=argument['markers'] == 'true',
    )


ARGUMENTS = {
    'scenario': ('a_loop', 'experiment to simulate'),
    'seed': ('0', 'of the radio noise, and of a walk that is drawn'),
    'rate': ('1.0', 'multiple of real time, or max'),
    'config': ('', 'parameter file or name of a configuration; empty: that of the scenario'),
    'record': ('', 'folder for a bag of what the world sends; empty: none'),
    'one_process_each': ('false', 'a process for every sensing node'),
    'markers': ('false', 'publish markers for RViz and Foxglove'),
    'namespace': ('', 'namespace of the whole graph'),
}


def generate_launch_description():
    return description(ARGUMENTS, _graph)

"""One table a graph: its processes, their parameters, what they take and give.

The launch files and the command line start what these functions return; the evaluator runs the same plans
without any process. Nothing here knows ROS beyond names.
"""

from wsn_tracking.graphs.follower import follower
from wsn_tracking.graphs.parts import How, Plan, Process, Source, complete, open_bag, source_of
from wsn_tracking.graphs.plans import SYSTEMS, configuration_of, plans_of, system_of
from wsn_tracking.graphs.random_q import BRIDGE
from wsn_tracking.graphs.whole import replay, serial, simulation

__all__ = [
    'BRIDGE',
    'SYSTEMS',
    'How',
    'Plan',
    'Process',
    'Source',
    'complete',
    'configuration_of',
    'follower',
    'open_bag',
    'plans_of',
    'replay',
    'serial',
    'simulation',
    'source_of',
    'system_of',
]

"""System B: nodes that agree with their neighbours, on a simulated field or on a bag.

ros2 launch wsn_tracking consensus.launch.py seed:=1
ros2 launch wsn_tracking consensus.launch.py bag:=bags/b_field rate:=max
ros2 launch wsn_tracking consensus.launch.py settings:='faults=clutter dead=[7,9]' parameters:='link.loss=0.3'
"""

from wsn_tracking.launching import tracking


def generate_launch_description():
    return tracking('consensus', scenario='b_field')

"""System A: sensing nodes, three estimators and the evaluator, on a simulated world or on a bag.

ros2 launch wsn_tracking random_q.launch.py scenario:=a_circle seed:=1 rate:=5.0
ros2 launch wsn_tracking random_q.launch.py parameters:='trigger.kind=near trigger.y_min=-46.9'
"""

from wsn_tracking.launching import tracking


def generate_launch_description():
    return tracking('random_q', scenario='a_loop')

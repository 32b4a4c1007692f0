"""System E: a cubature filter of a turning target that tolerates the loss of packets.

ros2 launch wsn_tracking loss_tolerant.launch.py settings:='loss=0.7 burst=5'
ros2 launch wsn_tracking loss_tolerant.launch.py bag:=bags/e_loss rate:=max
ros2 launch wsn_tracking loss_tolerant.launch.py parameters:='filter=hold'
"""

from wsn_tracking.launching import tracking


def generate_launch_description():
    return tracking('loss_tolerant', scenario='e_loss')

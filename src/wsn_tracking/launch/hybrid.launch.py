"""System D: a track for every target, by least squares and a Kalman filter of single ranges.

ros2 launch wsn_tracking hybrid.launch.py scenario:=d_stop settings:='dropout=0.3'
ros2 launch wsn_tracking hybrid.launch.py bag:=bags/d_phase rate:=max markers:=true
ros2 launch wsn_tracking hybrid.launch.py parameters:='form=imm'
"""

from wsn_tracking.launching import tracking


def generate_launch_description():
    return tracking('hybrid', scenario='d_phase')

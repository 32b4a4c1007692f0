"""System C: a particle filter of a person who wears a node.

ros2 launch wsn_tracking human.launch.py scenario:=c_walk seed:=1
ros2 launch wsn_tracking human.launch.py parameters:='profile=paper_max particles=1000' markers:=true
"""

from wsn_tracking.launching import tracking


def generate_launch_description():
    return tracking('human', scenario='c_walk')

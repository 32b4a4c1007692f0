"""Every tracker there is, alongside on one bag or one simulated world, and one table at the end.

ros2 launch wsn_tracking everything.launch.py bag:=bags/a_loop rate:=max
ros2 launch wsn_tracking everything.launch.py scenario:=e_loss seed:=1
"""

from wsn_tracking.launching import tracking


def generate_launch_description():
    return tracking('all', scenario='a_loop')

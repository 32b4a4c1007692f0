"""Nodes in tests see this machine only, and can be interrupted."""

import os
import signal

os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'
# Processes that run tests side by side ignore Ctrl-C, and what they start would inherit that.
signal.signal(signal.SIGINT, signal.default_int_handler)

"""Nodes in tests see this machine only, and can be interrupted; drawn inputs have no deadline."""

import os
import signal

from hypothesis import settings

os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'
# Processes that run tests side by side ignore Ctrl-C, and what they start would inherit that.
signal.signal(signal.SIGINT, signal.default_int_handler)
settings.register_profile('patient', settings(), deadline=None)
settings.load_profile('patient')

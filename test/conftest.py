"""What tests of several modules ask for by name; nodes in tests see this machine only, and can be interrupted."""

import contextlib
import os
import signal

import pytest
from hypothesis import settings

os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'
# Processes that run tests side by side ignore Ctrl-C, and what they start would inherit that.
signal.signal(signal.SIGINT, signal.default_int_handler)
# As in src/wsn_tracking/test/conftest.py; either may be the one that is loaded.
settings.register_profile('patient', settings(), deadline=None, derandomize=True)
settings.load_profile('patient')


@pytest.fixture
def link(tmp_path):
    """The name of a port."""
    return tmp_path / 'sink'


@pytest.fixture
def radio(link):
    """Starts simulated sinks behind that name; all are ended."""
    from radio import Radio

    with contextlib.ExitStack() as stack:

        def start(world, **config):
            made = Radio(link, world, **config)
            stack.enter_context(made.running())
            return made

        yield start


@pytest.fixture
def host(link):
    """Starts hosts of this project on that name; all are closed."""
    from radio import Heard

    with contextlib.ExitStack() as stack:

        def start(**config):
            made = Heard(link, **config)
            stack.callback(made.session.close)
            made.session.start()
            return made

        yield start

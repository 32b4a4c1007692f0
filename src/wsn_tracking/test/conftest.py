"""What tests of several modules ask for by name, and no deadline for drawn inputs.

How long a drawn input takes says how busy the machine is, not whether the program is right.
"""

import contextlib

import pytest
from cli_cases import Called, Started, save_bags
from fake_sink import FakeSink
from hypothesis import settings
from session_cases import Host

from wsn_tracking import processes

settings.register_profile('patient', settings(), deadline=None)
settings.load_profile('patient')


# ---- the command line


@pytest.fixture
def call(capsys):
    """Calls the command line."""
    return lambda *arguments: Called(capsys, *arguments)


@pytest.fixture(scope='session')
def bags(tmp_path_factory):
    """A folder of small bags, one of each kind; nobody writes into it."""
    return save_bags(tmp_path_factory.mktemp('bags'))


@pytest.fixture
def started(monkeypatch):
    """What would have been started."""
    noted = Started()
    monkeypatch.setattr(processes, 'run_graph', noted)
    return noted


# ---- the serial line


@pytest.fixture
def link(tmp_path):
    """The name of a port."""
    return tmp_path / 'sink'


@pytest.fixture
def sink(link):
    """A fake sink behind that name."""
    with contextlib.closing(FakeSink(link)) as fake:
        yield fake


@pytest.fixture
def host(link):
    """Starts hosts on that name; all are closed."""
    with contextlib.ExitStack() as stack:

        def start(**config):
            made = Host(link, **config)
            stack.callback(made.session.close)
            return made

        yield start

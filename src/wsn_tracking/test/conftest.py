"""What tests of several modules ask for by name, and how inputs are drawn.

Drawn inputs are the same in every run: a red test is red for everybody. They have no deadline: how long one takes says
how busy the machine is, not whether the program is right. Helpers are imported where they are asked for, so that their
own settings build upon these.
"""

import contextlib

import pytest
from hypothesis import settings

settings.register_profile('patient', settings(), deadline=None, derandomize=True)
settings.load_profile('patient')


# ---- the command line


@pytest.fixture
def call(capsys):
    """Calls the command line."""
    from cli_cases import Called

    return lambda *arguments: Called(capsys, *arguments)


@pytest.fixture(scope='session')
def bags(tmp_path_factory):
    """A folder of small bags, one of each kind; nobody writes into it."""
    from cli_cases import save_bags

    return save_bags(tmp_path_factory.mktemp('bags'))


@pytest.fixture
def started(monkeypatch):
    """What would have been started."""
    from cli_cases import Started

    from wsn_tracking import processes

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
    from fake_sink import FakeSink

    with contextlib.closing(FakeSink(link)) as fake:
        yield fake


@pytest.fixture
def host(link):
    """Starts hosts on that name; all are closed."""
    from session_cases import Host

    with contextlib.ExitStack() as stack:

        def start(**config):
            made = Host(link, **config)
            stack.callback(made.session.close)
            return made

        yield start

"""Two robots in phase, live: ranges up a simulated serial line, estimates down it, wheels by what comes down."""

from __future__ import annotations

import numpy as np
import pytest

import live
from wsn_tracking import follower


@pytest.fixture
def _alone(monkeypatch):
    """In a domain of its own."""
    with live.private_domain() as environment:
        for name in ('ROS_DOMAIN_ID', 'ROS_AUTOMATIC_DISCOVERY_RANGE'):
            monkeypatch.setenv(name, environment[name])
        yield


@pytest.mark.usefixtures('_alone')
def test_the_second_robot_drives_by_what_comes_back_through_the_sink(tmp_path, capsys):
    """It begins a third of a turn behind; without feedback it would stand, and fall back by 0.6 rad a second."""
    out = tmp_path / 'out'
    assert follower.main(['-o', str(out), '--lasts', '5', '--seed', '4']) == 0
    told = dict(line.split() for line in capsys.readouterr().out.splitlines())
    assert float(told['rms_deg']) < np.degrees(1.0)
    assert float(told['tracking_rmse_cm']) < 20.0
    assert (out / 'phase.png').read_bytes().startswith(b'\x89PNG')


def test_what_is_there_is_not_written_over(tmp_path, capsys):
    assert follower.main(['-o', str(tmp_path)]) == 1
    assert 'exists: name another folder' in capsys.readouterr().err
    assert follower.main(['-o', str(tmp_path / 'x'), '--set', 'driven.behind=far']) == 1
    assert "parameter `driven.behind` is 'far': expected a number" in capsys.readouterr().err

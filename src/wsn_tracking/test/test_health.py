"""Every WARN and ERROR condition of docs/diagnostics.md, on both sides of its threshold."""

from __future__ import annotations

import pytest

from wsn_tracking.nodes import health
from wsn_tracking.nodes.health import ERROR, OK, WARN


@pytest.mark.parametrize(
    ('age', 'ended', 'level'),
    [(None, False, OK), (4.9, False, OK), (5.1, False, ERROR), (5.1, True, OK), (0.0, True, OK)],
)
def test_requests_that_stop_are_an_error_and_no_request_yet_is_none(age, ended, level):
    assert health.flow(age, ended, timeout=5.0).level == level


def test_error_says_how_long_it_has_been_quiet():
    assert '7.2 s' in health.flow(7.2, ended=False, timeout=5.0).sentence


@pytest.mark.parametrize(('absent', 'level'), [((), OK), ((2,), WARN), ((3, 1), WARN)])
def test_absent_peers_warn_and_are_named(absent, level):
    said = health.peers(absent)
    assert said.level == level
    assert all(str(number) in said.sentence for number in absent)


def test_outputs_that_were_given_up_warn_and_are_named():
    assert health.outputs(()).level == OK
    said = health.outputs({'estimate/fused_2'})
    assert said.level == WARN
    assert 'estimate/fused_2' in said.sentence


@pytest.mark.parametrize(('estimates', 'poses', 'level'), [(0, 0, OK), (0, 3, OK), (3, 3, OK), (3, 0, WARN)])
def test_estimates_without_truth_warn(estimates, poses, level):
    assert health.truth(estimates, poses).level == level


def test_worst_condition_is_told():
    error, warning, fine = (health.Health(level, str(level)) for level in (ERROR, WARN, OK))
    assert health.worst(fine, error, warning) == error
    assert health.worst(fine, warning) == warning


def test_radios_that_mislead_warn_and_say_how():
    assert health.radio((), '') == health.Health(OK, '')
    both = health.radio({7, 3}, 'set lqi_scale to cc26x2')
    assert both == health.Health(WARN, 'two radios bear the id of nodes [3, 7]; LQI: set lqi_scale to cc26x2')
    assert health.radio((), 'no known scale fits').level == health.radio({3}, '').level == WARN

"""The mean and LCI that the live evaluator makes of local estimates are those of the offline run."""

from __future__ import annotations

import pytest
from graph_cases import a_loop
from run_cases import estimators, run

from wsn_tracking.bags.estimates import differences
from wsn_tracking.evaluation.compared import fused_by
from wsn_tracking.trackers.fusing import compared

LOCALS = ('local_1', 'local_2', 'local_3')
HOUR = 3600 * 10**9


def beside(result):
    """Every rule's estimates from the local estimates alone."""
    locals_ = [result.estimates[name] for name in LOCALS]
    return {fuser.source: fused_by(fuser, locals_) for fuser in compared(estimators()[0].fusion)}


@pytest.mark.parametrize('later', [None, 0, HOUR, -HOUR], ids=['once', 'looped', 'restarted', 'clock set back'])
def test_local_estimates_alone_give_what_the_run_gave(later):
    once = a_loop(8)
    again = () if later is None else tuple(m._replace(stamp_ns=m.stamp_ns + later) for m in once.messages)
    result = run(once._replace(messages=(*once.messages, *again)))
    for name, estimates in beside(result).items():
        assert len(estimates) == result.epochs == 8 if later is None else 16
        assert differences(estimates, result.estimates[name]) == []


def test_an_epoch_that_an_estimator_missed_is_left_out():
    result = run()
    whole, *others = (result.estimates[name] for name in LOCALS)
    for fuser in compared(estimators()[0].fusion):
        fused = fused_by(fuser, [whole[:3] + whole[4:], *others])
        assert [e.request_seq for e in fused] == [k for k in range(12) if k != 3]


def test_of_no_estimates_nothing_is_made():
    mean, _ = compared(estimators()[0].fusion)
    assert fused_by(mean, []) == fused_by(mean, [(), ()]) == []

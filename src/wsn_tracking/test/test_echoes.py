"""A feed notices that another graph answers it, too."""

from __future__ import annotations

from wsn_tracking.nodes.echoes import Echoes

ONCE = [(1, 0), (1, 1), (2, 0)]


def told(epochs, *answers):
    echoes = Echoes(epochs)
    return [echoes.is_one(output, key) for output, key in answers]


def test_each_output_tells_each_epoch_once():
    answers = [(output, key) for key in ONCE for output in ('fused_1', 'fused_2')]
    assert told(ONCE, *answers) == [False] * 6


def test_an_epoch_that_is_told_again_is_somebody_elses():
    assert told(ONCE, ('fused_1', (1, 0)), ('fused_1', (1, 1)), ('fused_1', (1, 0))) == [False, False, True]


def test_a_looped_bag_is_answered_twice():
    answers = [('fused_1', key) for key in [*ONCE, *ONCE, (1, 1)]]
    assert told(ONCE * 2, *answers) == [False] * 6 + [True]


def test_what_was_never_sent_tells_nothing():
    assert told(ONCE, *[('fused_1', (1, 9))] * 3) == [False] * 3

"""Draws belong to their seed, their drawer and their epoch."""

import numpy as np
import pytest

from wsn_tracking.models.draws import Stream, keyed


def test_a_draw_does_not_depend_on_what_was_drawn_before():
    keys = [(seed, who, epoch) for seed in (0, 3) for who in (1, 2**32) for epoch in (0, 1, 500)]
    forward = {key: keyed(*key).random(3).tolist() for key in keys}
    backward = {key: keyed(*key).random(3).tolist() for key in reversed(keys)}
    assert forward == backward


def test_a_stream_gives_each_epochs_draws_in_whatever_order():
    for seed, who in [(0, 1), (7, 2**33 + 3), (2**63 + 1, 2**64 - 1), (-1, 5)]:
        stream = Stream(seed, who)
        for epoch in (3, 0, 3, 2**40, 1, 1):
            np.testing.assert_array_equal(stream.at(epoch).random(9), keyed(seed, who, epoch).random(9))
            assert stream.at(epoch).uniform(2.0, 12.0) == keyed(seed, who, epoch).uniform(2.0, 12.0)


def test_seeds_drawers_and_epochs_have_streams_of_their_own():
    keys = [(s, w, e) for s in range(4) for w in (*range(6), 2**32, 2**33) for e in (*range(6), 2**40)]
    firsts = {keyed(*key).random() for key in keys}
    assert len(firsts) == len(keys)
    assert keyed(-1, 1, 1).random() != keyed(1, 1, 1).random()


@pytest.mark.parametrize('axis', [0, 1, 2])
def test_first_draws_are_uniform_and_uncorrelated_along_every_key(axis):
    stats = pytest.importorskip('scipy.stats')
    keys = np.ones((4000, 3), dtype=int)
    keys[:, axis] = np.arange(4000)
    u = np.array([keyed(*key).random() for key in keys.tolist()])
    assert stats.kstest(u, 'uniform').pvalue > 0.01
    # the correlation of independent neighbours has the standard deviation 1/sqrt(4000) = 0.016
    assert abs(np.corrcoef(u[1:], u[:-1])[0, 1]) < 0.05

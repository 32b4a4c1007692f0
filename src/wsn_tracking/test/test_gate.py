"""Fusion waits for whoever lives, in the order of epochs, and drops nothing silently."""

from __future__ import annotations

from collections import deque

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from wsn_tracking.trackers import gate as gate_module
from wsn_tracking.trackers.estimate import Estimate
from wsn_tracking.trackers.gate import FusionGate

TIMEOUT = 1.0
SECOND = 1_000_000_000


def estimate(number, k, at=None):
    """Of estimator `number` for epoch k; the instant is k unless the target counts anew."""
    stamp = round((k if at is None else at) * SECOND)
    return Estimate(stamp, 1, k, f'local_{number}', np.zeros(4), np.eye(4), (number,))


def gate(peers=(1, 2, 3)):
    return FusionGate(1, peers, TIMEOUT)


def told(ready):
    """(epoch, contributors) of what is fused."""
    return [(group[0].request_seq, tuple(e.contributors[0] for e in group)) for group in ready]


def test_one_estimator_alone_never_waits():
    alone = gate(peers=())
    alone.own_estimate(estimate(1, 0), 0.0)
    assert alone.waiting
    assert told(alone.ready(0.0)) == [(0, (1,))]
    assert not alone.waiting


def test_an_epoch_waits_for_every_peer_and_no_longer():
    g = gate()
    g.peer_estimate(3, estimate(3, 0))
    g.own_estimate(estimate(1, 0), 5.0)
    assert g.ready(5.5) == []
    g.peer_estimate(2, estimate(2, 0))
    assert told(g.ready(5.5)) == [(0, (1, 2, 3))]
    assert g.counters == {}


def test_a_later_epoch_does_not_pass_an_earlier_one():
    g = gate(peers=(1, 2))
    g.own_estimate(estimate(1, 0), 0.0)
    g.own_estimate(estimate(1, 1), 0.1)
    assert g.ready(0.9) == []
    g.peer_estimate(2, estimate(2, 0))
    g.peer_estimate(2, estimate(2, 1))
    assert told(g.ready(0.9)) == [(0, (1, 2)), (1, (1, 2))]


def test_a_peer_that_skips_an_epoch_is_not_waited_for_in_that_one():
    """Its messages come in order: after epoch 1 nothing of epoch 0 will come."""
    g = gate(peers=(1, 2))
    g.own_estimate(estimate(1, 0), 0.0)
    g.peer_estimate(2, estimate(2, 1))
    assert told(g.ready(0.0)) == [(0, (1,))]
    assert g.counters == {'missing_peer': 1}
    g.own_estimate(estimate(1, 1), 0.0)
    assert told(g.ready(0.0)) == [(1, (1, 2))]
    assert g.absent == ()


def test_a_peer_that_speaks_of_every_fourth_epoch_is_alive():
    g = gate(peers=(1, 2))
    g.peer_estimate(2, estimate(2, 4))
    for k in range(4):
        g.own_estimate(estimate(1, k), 0.0)
    assert len(g.ready(0.0)) == 4
    assert g.absent == ()
    g.own_estimate(estimate(1, 4), 0.0)
    assert told(g.ready(0.0)) == [(4, (1, 2))]


def test_after_three_silent_epochs_a_peer_is_not_waited_for_until_it_speaks():
    g = gate(peers=(1, 2))
    for k in range(3):
        g.own_estimate(estimate(1, k), float(2 * k))
        assert g.ready(2 * k + 0.99) == []
        assert told(g.ready(2 * k + 1.0)) == [(k, (1,))]
    assert g.absent == (2,)
    g.own_estimate(estimate(1, 3), 6.0)
    assert told(g.ready(6.0)) == [(3, (1,))]
    assert g.counters == {'missing_peer': 3}
    g.peer_estimate(2, estimate(2, 3))  # too late, but it lives
    assert g.counters['late_peer'] == 1
    assert g.absent == ()
    g.own_estimate(estimate(1, 4), 7.0)
    assert g.ready(7.5) == []
    g.peer_estimate(2, estimate(2, 4))
    assert told(g.ready(7.5)) == [(4, (1, 2))]


def test_one_dead_peer_does_not_keep_a_living_one_out():
    g = gate()
    for k in range(6):
        g.own_estimate(estimate(1, k), 10.0 * k)
        g.peer_estimate(2, estimate(2, k))
        now = 10.0 * k + (TIMEOUT if k < 3 else 0.0)
        assert told(g.ready(now)) == [(k, (1, 2))]
    assert g.absent == (3,)


def test_each_reason_has_a_counter(monkeypatch):
    monkeypatch.setattr(gate_module, 'MAX_HELD', 3)
    g = gate(peers=(1, 2))
    g.peer_estimate(7, estimate(7, 0))
    g.peer_estimate(1, estimate(1, 0))  # itself is no peer
    assert g.counters == {'unknown_peer': 2}
    for k in (0, 0, 1, 2, 3):
        g.peer_estimate(2, estimate(2, k))
    assert g.counters == {'unknown_peer': 2, 'duplicate_peer': 1, 'peer_overflow': 1}
    assert g.held == 3
    g.own_estimate(estimate(1, 2), 0.0)
    assert told(g.ready(0.0)) == [(2, (1, 2))]
    assert g.counters['late_peer'] == 2  # of epochs 0 and 1
    assert g.held == 0


def test_a_target_that_counts_anew_is_fused_without_a_pause():
    """Epochs are told apart by number and stamp; a peer may be ahead or behind."""
    g = gate()
    numbers = [(7, 7.0), (8, 8.0), (0, 9.0), (1, 10.0), (2, 11.0)]
    for number, lead in ((2, 3), (3, 0)):
        for k, at in numbers[:lead]:
            g.peer_estimate(number, estimate(number, k, at))
    out = []
    for i, (k, at) in enumerate(numbers):
        g.own_estimate(estimate(1, k, at), 0.0)
        out += told(g.ready(0.0))
        g.peer_estimate(3, estimate(3, k, at))
        if i >= 3:
            g.peer_estimate(2, estimate(2, k, at))
        out += told(g.ready(0.0))
    assert out == [(k, (1, 2, 3)) for k, _ in numbers]
    assert g.counters == {}
    assert g.held == 0


def test_a_reset_forgets_the_past():
    g = gate(peers=(1, 2))
    g.own_estimate(estimate(1, 5), 0.0)
    g.peer_estimate(2, estimate(2, 6))
    g.reset()
    assert (g.waiting, g.held, g.absent, g.ready(99.0)) == (False, 0, (), [])
    g.own_estimate(estimate(1, 0), 0.0)
    g.peer_estimate(2, estimate(2, 0))
    assert told(g.ready(0.0)) == [(0, (1, 2))]


epochs = st.integers(1, 8)


@given(epochs, st.integers(0, 3), st.randoms(use_true_random=False))
@settings(max_examples=100)
def test_without_losses_the_order_of_arrival_changes_nothing(n, restart, rng):
    """Any interleaving of what the estimators publish, also across a target that counts anew."""
    numbers = [(k if k < n else k - n, float(k)) for k in range(n + restart)]
    queues = {number: deque(estimate(number, k, at) for k, at in numbers) for number in (1, 2, 3)}
    g, out = gate(), []
    while any(queues.values()):
        number = rng.choice(sorted(i for i, queue in queues.items() if queue))
        message = queues[number].popleft()
        if number == 1:
            g.own_estimate(message, 0.0)
        else:
            g.peer_estimate(number, message)
        out += told(g.ready(0.0))
    assert out == [(k, (1, 2, 3)) for k, _ in numbers]
    assert g.counters == {}


moves = st.lists(
    st.tuples(st.sampled_from([1, 2, 2, 3, 4]), st.integers(0, 6), st.sampled_from([0.0, 0.3, 2.0])), max_size=40
)


@given(moves)
@settings(max_examples=200)
def test_every_peer_estimate_is_fused_counted_once_or_held(steps):
    """Losses, repetitions, strangers, any order; own epochs rise."""
    g, now, own, given_, fused, out = gate(), 0.0, 0, 0, 0, []
    for number, k, later in steps:
        now += later
        if number == 1:
            own += 1 + k // 5
            g.own_estimate(estimate(1, own), now)
        else:
            given_ += 1
            g.peer_estimate(number, estimate(number, k))
        ready = g.ready(now)
        fused += sum(len(group) - 1 for group in ready)
        out += [group[0].request_seq for group in ready]
        assert all(len({e.contributors for e in group}) == len(group) for group in ready)
        assert all(len({e.request_seq for e in group}) == 1 for group in ready)
        counted = sum(g.counters[c] for c in ('late_peer', 'duplicate_peer', 'unknown_peer', 'peer_overflow'))
        assert given_ == fused + counted + g.held
    assert out == sorted(set(out))

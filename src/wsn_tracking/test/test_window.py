"""A feed stays close to its outputs, whichever of them is slow, and gives up on one that is silent."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

from wsn_tracking.nodes.window import Window

A, B = 'estimate/fused_1', 'estimate/fused_2'


def window(epochs=10, size=4, topics=(A, B), timeout=5.0):
    w = Window(dict.fromkeys(topics, -1), [(1, k) for k in range(epochs)], size, timeout)
    w.begin(0.0)
    return w


def sent(w, first, now=0.0):
    """The epochs from `first` on that are admitted at once."""
    k = first
    while k < 100 and w.admits(k, now):
        k += 1
    return k - first


def test_the_feed_begins_with_a_window_of_epochs():
    w = window()
    assert sent(w, 0) == 4
    assert w.state() == {'epoch': 3, f'reached.{A}': -1, f'reached.{B}': -1}


def test_the_slowest_output_sets_the_pace():
    w = window()
    assert sent(w, 0) == 4
    for k in range(4):
        w.heard(A, 1, k, 0.1)
    assert sent(w, 4) == 0
    w.heard(B, 1, 1, 0.2)
    assert sent(w, 4) == 2


def test_messages_of_an_admitted_epoch_stay_admitted():
    w = window()
    assert sent(w, 0) == 4
    assert w.admits(2, 1.0)


def test_without_outputs_nothing_holds_the_feed_back():
    w = window(topics=())
    assert sent(w, 0) == 100
    assert w.finished()
    assert w.silent(1e9) == []


def test_a_silent_output_is_given_up_once_and_no_longer_waited_for():
    w = window()
    assert sent(w, 0) == 4
    for k in range(4):
        w.heard(A, 1, k, 1.0)
    assert w.silent(5.0) == []
    assert w.silent(5.1) == [B]
    assert w.silent(99.0) == []
    assert w.given_up == {B}
    assert sent(w, 4, 5.1) == 4


def test_an_output_that_speaks_again_is_waited_for_again():
    """But that it was silent is not forgotten: the feed ends with an error."""
    w = window()
    sent(w, 0)
    for k in range(4):
        w.heard(A, 1, k, 1.0)
    w.silent(6.0)
    sent(w, 4, 6.0)
    w.heard(B, 1, 3, 7.0)
    for k in range(4, 8):
        w.heard(A, 1, k, 7.0)
    assert sent(w, 8, 7.0) == 0
    assert w.given_up == {B}


def test_an_output_level_with_the_feed_is_not_silent_however_long_nothing_is_sent():
    w = window(topics=(A,))
    w.admits(0, 0.0)
    w.heard(A, 1, 0, 0.1)
    assert w.silent(1000.0) == []
    w.admits(1, 1000.0)  # its time runs from here
    assert w.silent(1004.9) == []
    assert w.silent(1005.1) == [A]


def test_all_is_finished_when_every_output_has_reached_the_end():
    w = window(epochs=3)
    sent(w, 0)
    for k in range(3):
        w.heard(A, 1, k, 0.0)
    assert not w.finished()
    w.heard(B, 1, 2, 0.0)
    assert w.finished()


def test_all_is_finished_when_the_rest_is_given_up():
    w = window(epochs=3)
    sent(w, 0)
    w.heard(A, 1, 2, 4.0)
    assert w.silent(6.0) == [B]
    assert w.finished()


def test_an_estimate_of_what_was_not_sent_moves_nothing():
    w = window(topics=(A,))
    w.admits(0, 0.0)
    w.heard(A, 1, 7, 0.0)  # of an earlier feed
    w.heard(A, 9, 0, 0.0)  # of a target that is not in the bag
    assert w.state()[f'reached.{A}'] == -1


def test_in_a_looped_bag_an_epoch_counts_where_the_feed_is():
    w = Window({A: -1}, [(1, k % 10) for k in range(30)], 4, 5.0)
    w.begin(0.0)
    k = 0
    while k < 30:
        assert w.admits(k, 0.0)
        w.heard(A, 1, k % 10, 0.0)
        assert w.state()[f'reached.{A}'] == k
        k += 1
    assert w.finished()


def test_epochs_of_other_targets_do_not_hold_the_feed_back():
    """An output speaks of one target; a stretch without it, also the last, passes by."""
    epochs = [(1, 0), (1, 1), *((2, k) for k in range(20)), (1, 2), *((2, k) for k in range(20, 25))]
    w = Window({A: -1}, epochs, 4, 5.0)
    w.begin(0.0)
    assert sent(w, 0) == 4
    w.heard(A, 1, 0, 0.0)
    w.heard(A, 1, 1, 0.0)
    assert sent(w, 4) == 22
    assert not w.finished()
    w.heard(A, 1, 2, 0.0)
    assert w.finished()
    assert w.silent(1e9) == []


def test_an_output_whose_target_comes_late_is_waited_for_from_then_on():
    epochs = [*((2, k) for k in range(20)), (1, 0), (1, 1), (1, 2)]
    w = Window({A: 1, B: 2}, epochs, 2, 5.0)
    w.begin(0.0)
    for k in range(20):
        assert w.admits(k, 0.0)
        w.heard(B, 2, k, 0.0)
    assert w.silent(1e9) == []
    assert sent(w, 20, 1e9) == 2
    assert w.silent(1e9 + 5.1) == [A]
    absent = Window({A: 3}, epochs, 2, 5.0)
    absent.begin(0.0)
    assert absent.finished()  # its target is not there at all


@given(st.integers(1, 6), st.integers(1, 30), st.integers(1, 3), st.randoms(use_true_random=False))
@settings(max_examples=80)
def test_the_feed_is_never_further_ahead_than_the_window_and_always_ends(size, n, outputs, rng):
    topics = [f'out_{i}' for i in range(outputs)]
    w = window(n, size, topics)
    reached, k = dict.fromkeys(topics, -1), 0
    for _ in range(10_000):
        if w.finished() and k == n:
            break
        topic = rng.choice(topics)
        if rng.random() < 0.5 and reached[topic] < k - 1:
            reached[topic] += 1
            w.heard(topic, 1, reached[topic], 0.0)
        elif k < n and w.admits(k, 0.0):
            assert k - min(reached.values()) <= size
            k += 1
    assert k == n
    assert w.finished()
    assert w.given_up == set()

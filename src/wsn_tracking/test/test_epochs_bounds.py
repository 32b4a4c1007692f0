"""Garbage is counted, fills no memory and keeps no epoch open."""

from __future__ import annotations

import math
import random

from epoch_cases import NODES, SECOND, START, Stream, end, give, packet, stamp, unaccounted
from hypothesis import given, settings
from hypothesis import strategies as st

from wsn_tracking.sensing import epochs as epochs_module
from wsn_tracking.sensing import open_epochs
from wsn_tracking.sensing.epochs import EpochAssembler
from wsn_tracking.sensing.values import EpochEnd, Request, Rssi, TriggerReport

SMALL = st.integers(0, 6)
targets = st.sampled_from([1, 1, 1, 1, 2])
stamps = st.integers(0, 9).map(lambda k: START + k * SECOND // 2)
ids = st.integers(0, 4)
garbage_messages = st.one_of(
    st.builds(Request, stamps, targets, SMALL),
    st.builds(Rssi, stamps, ids, targets, st.integers(0, 3), SMALL, st.sampled_from([-50.0, -60.0, 127.0, math.nan])),
    st.tuples(stamps, targets, SMALL, st.lists(st.tuples(ids, st.integers(0, 3)), max_size=4)).map(
        lambda t: EpochEnd(*t[:3], 'rssi', tuple(n for n, _ in t[3]), tuple(s for _, s in t[3]))
    ),
    st.tuples(stamps, targets, SMALL, st.lists(ids, unique=True, max_size=4), st.integers(0, 4)).map(
        lambda t: TriggerReport(*t[:3], tuple(t[3][: t[4]]), (0,) * len(t[3][: t[4]]), tuple(t[3][t[4] :]), ())
    ),
)


@given(st.lists(st.tuples(garbage_messages, st.sampled_from([0.0, 0.0, 0.5, 3.0])), max_size=60))
@settings(max_examples=250)
def test_every_message_is_used_counted_once_or_held(steps):
    assembler, now = EpochAssembler((1, 2), known=(1, 2, 3), loss_timeout=1.0), 0.0
    numbers = []
    for count, (message, later) in enumerate(steps, 1):
        now += later
        give(assembler, message, now)
        assert unaccounted(assembler, count) == 0
        numbers += [(assembler.runs, epoch) for epoch in assembler.closed(now)]
        assert unaccounted(assembler, count) == 0
    for _, epoch in numbers:
        nodes = [p.node_id for p in epoch.measurements]
        assert nodes == sorted(set(nodes))
        assert set(nodes) <= {1, 2}
        assert epoch.target_id == assembler.target_id
    assert sum(assembler.counters[c] for c in ('epochs',)) == len(numbers)
    while assembler.closed(now := now + 10.0):
        pass
    assert unaccounted(assembler, len(steps)) == 0


def test_garbage_fills_no_memory_and_does_not_stop_the_target(monkeypatch):
    """Random numbers before and between the real messages; every real epoch still closes, in order and whole."""
    monkeypatch.setattr(open_epochs, 'MAX_OPEN', 20)
    monkeypatch.setattr(epochs_module, 'MAX_OPEN', 20)
    monkeypatch.setattr(open_epochs, 'MAX_SIZE', 60)
    rng = random.Random(3)
    assembler, out, count = EpochAssembler(NODES), [], 0
    stream = Stream([(1, 1, 1)] * 30, 'end', first=100)
    for k in range(30):
        for _ in range(50):
            number, node = rng.randrange(1000, 2**32), rng.choice(NODES)
            nonsense = [
                packet(node, rng.randrange(2**16), number, k),
                packet(node, rng.randrange(2**16), 1000, k),  # many packets of one epoch
                EpochEnd(stamp(k), 1, number, 'rssi', NODES * 3, tuple(rng.randrange(2**16) for _ in NODES * 3)),
            ]
            give(assembler, rng.choice(nonsense), float(k))
            count += 1
        for name in ('node_1', 'node_2', 'node_3', 'end', 'request'):
            give(assembler, stream.queues[name][k][1], float(k))
            count += 1
        out += assembler.closed(float(k))
        assert unaccounted(assembler, count) == 0
        assert assembler.held <= 60 + 9
    assert out == stream.epochs
    assert assembler.counters['overflow'] > 1000


def test_what_lies_furthest_in_the_future_gives_way(monkeypatch):
    """Of epochs that no request has asked for yet, the next are the likeliest to be real."""
    monkeypatch.setattr(open_epochs, 'MAX_OPEN', 3)
    assembler = EpochAssembler(NODES)
    for number in (11, 12, 500, 900, 13, 14, 800):
        give(assembler, packet(1, 0, number, 0.0))
    assert assembler.counters['overflow'] == 4
    for k, number in enumerate((11, 12, 13)):
        give(assembler, Request(stamp(k), 1, number))
        give(assembler, end(number, [packet(1, 0, number, 0.0)], float(k)))
    assert [len(epoch.measurements) for epoch in assembler.closed(0.0)] == [1, 1, 1]


def test_packets_without_end_of_one_epoch_do_not_keep_it_open(monkeypatch):
    monkeypatch.setattr(open_epochs, 'MAX_SIZE', 50)
    assembler = EpochAssembler(NODES, loss_timeout=1.0)
    give(assembler, Request(stamp(0), 1, 0))
    for seq in range(500):
        give(assembler, packet(1, seq, 0, 0.0), 0.1 * seq)
    assert assembler.held == 51
    (epoch,) = assembler.closed(0.1 * 499)
    assert epoch.measurements[0].n_samples == 50
    assert assembler.counters['overflow'] == 450


def test_a_repeated_packet_is_no_news_and_does_not_keep_an_epoch_open():
    assembler = EpochAssembler(NODES, loss_timeout=1.0)
    give(assembler, Request(stamp(0), 1, 0))
    for k in range(12):
        give(assembler, packet(1, 0, 0, 0.0), 0.1 * k)
        give(assembler, end(0, [packet(1, 0, 0, 0.0), packet(2, 0, 0, 0.0)], 0.0), 0.1 * k)
    assert assembler.counters['duplicate'] == 11
    assert len(assembler.closed(1.0)) == 1


def test_too_many_epochs_are_closed_without_what_they_lack(monkeypatch):
    monkeypatch.setattr(open_epochs, 'MAX_OPEN', 10)
    monkeypatch.setattr(epochs_module, 'MAX_OPEN', 10)
    assembler, out = EpochAssembler(NODES), []
    for k in range(15):
        give(assembler, Request(stamp(k), 1, k))
        out += assembler.closed(0.0)
    assert [epoch.request_seq for epoch in out] == [0, 1, 2, 3, 4]
    assert assembler.counters['unlisted_epoch'] == 5
    assert assembler.held == 10


def test_the_messages_of_a_new_run_are_held_within_bounds(monkeypatch):
    monkeypatch.setattr(epochs_module, 'MAX_AHEAD', 3)
    assembler = EpochAssembler(NODES)
    give(assembler, Request(stamp(9), 1, 5))
    give(assembler, Request(stamp(0), 1, 0))
    for seq in range(4):
        give(assembler, packet(1, seq, 0, 0.0))
    assert assembler.counters['overflow'] == 2
    assert unaccounted(assembler, 6) == 0
    assert assembler.held == 1 + 3

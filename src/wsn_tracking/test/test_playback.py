"""The order in which a recording is sent and saved."""

from __future__ import annotations

import math

import numpy as np
from epoch_cases import START, end, packet, report, stamp
from hypothesis import given, settings
from hypothesis import strategies as st

from wsn_tracking.bags.messages import TruthPose
from wsn_tracking.bags.playback import TOPICS, playback
from wsn_tracking.bags.read import read
from wsn_tracking.bags.save import save
from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.sensing.recording import Recording, Truth
from wsn_tracking.sensing.values import Range, RangeBearing, Request, Rssi


def truth(times, target=1):
    n = len(times)
    stamps = np.array([stamp(t) for t in times], dtype=np.int64)
    return Truth(target, stamps, np.arange(3.0 * n).reshape(n, 3), np.full((n, 3), 0.5))


def recording(messages, truths=(), level='rssi'):
    anchors = make_anchors([1, 2], [[0.0, 0.0], [1.0, 0.0]])
    return Recording(anchors, level, tuple(messages), {t.target_id: t for t in truths}, {'entry_level': level}, {})


def epoch(number, at, target=1):
    sent = packet(1, number, number, at, target=target)
    return [Request(stamp(at), target, number), sent, end(number, [sent], at, target=target)]


def test_messages_keep_the_order_of_the_log():
    messages = [*epoch(0, 0.0), *epoch(2, 1.0)[::-1], *epoch(1, 0.5)]
    played = playback(recording(messages))
    assert [event.value for event in played.events] == messages
    assert [event.stamp_ns for event in played.events] == [m.stamp_ns for m in messages]
    assert played.epochs == ((1, 0), (1, 2), (1, 1))
    assert [event.epoch for event in played.events] == [0, 0, 0, 1, 1, 1, 2, 2, 2]


def test_every_kind_has_its_topic():
    values = [
        Request(START, 1, 0),
        packet(1, 0, 0, 0.0),
        Range(START, 1, 1, 0, 0, 1, 2.0),
        RangeBearing(START, 1, 1, 0, 0, 2.0, 0.1, (1.0, 0.0, 0.0, 1.0)),
        report(0, [], (1,), 0.0),
        end(0, [], 0.0),
    ]
    assert [event.topic for event in playback(recording(values)).events] == [
        'request', 'rssi', 'range', 'observation', 'trigger_report', 'epoch_end'
    ]  # fmt: skip
    assert set(TOPICS) == {type(value) for value in values}


def test_an_empty_recording_is_no_events():
    assert playback(recording([], [truth([0.0])])) == ((), ())


@given(
    st.lists(st.integers(0, 40), min_size=1, max_size=8, unique=True),
    st.lists(st.lists(st.integers(-10, 60), min_size=1, max_size=10, unique=True), min_size=1, max_size=3),
)
@settings(max_examples=100)
def test_the_truth_of_every_target_is_ahead_of_what_it_judges(instants, tracks):
    """Both neighbours in time of every epoch have been sent before the epoch begins, where there are any."""
    truths = [truth([t / 4 for t in sorted(track)], target) for target, track in enumerate(tracks, 1)]
    messages = [m for k, at in enumerate(sorted(instants)) for m in epoch(k, at / 4)]
    played = playback(recording(messages, truths))
    sent = {t.target_id: [] for t in truths}
    for event in played.events:
        if isinstance(event.value, TruthPose):
            assert event.topic == f'truth/target_{event.value.target_id}'
            sent[event.value.target_id].append(event.value.stamp_ns)
            continue
        for t in truths:
            known = set(sent[t.target_id])
            before, after = t.stamps_ns[t.stamps_ns <= event.stamp_ns], t.stamps_ns[t.stamps_ns >= event.stamp_ns]
            assert set(before.tolist()) <= known
            assert after.size == 0 or int(after[0]) in known
    for t in truths:
        told = sent[t.target_id]
        assert told == t.stamps_ns[: len(told)].tolist()  # ascending, each once
        assert all(s < messages[-1].stamp_ns for s in told[1:-1])  # no further ahead than needed


def test_truth_travels_whole():
    played = playback(recording(epoch(0, 0.0), [truth([0.0])]))
    assert played.events[0].value == TruthPose(START, 1, (0.0, 1.0, 2.0), (0.5, 0.5, 0.5))
    assert played.events[0].epoch == 0


def test_a_target_that_counts_anew_has_epochs_of_its_own():
    messages = [*epoch(0, 0.0), *epoch(1, 1.0), *epoch(0, 2.0), *epoch(1, 3.0)]
    played = playback(recording(messages))
    assert played.epochs == ((1, 0), (1, 1), (1, 0), (1, 1))
    assert [event.epoch for event in played.events] == [0] * 3 + [1] * 3 + [2] * 3 + [3] * 3


def test_a_packet_ahead_of_its_request_is_of_the_same_epoch():
    request, sent, closing = epoch(4, 0.0)
    played = playback(recording([sent, request, closing]))
    assert played.epochs == ((1, 4),)


def test_targets_number_their_epochs_apart():
    played = playback(recording([*epoch(0, 0.0), *epoch(0, 0.1, target=2)]))
    assert played.epochs == ((1, 0), (2, 0))


def test_a_saved_recording_reads_back(tmp_path):
    given_ = recording([*epoch(0, 0.0), *epoch(1, 1.0)], [truth([0.0, 0.5, 1.0])])
    save(tmp_path / 'bag', given_)
    back = read(tmp_path / 'bag')
    assert back.messages == given_.messages
    assert back.truth[1].positions.tolist() == given_.truth[1].positions.tolist()
    assert dict(back.metadata) == {'entry_level': 'rssi'}


def test_a_looped_recording_keeps_its_order(tmp_path):
    """Readers sort by log time, so that it must not fall where stamps do."""
    messages = [*epoch(0, 0.0), *epoch(1, 1.0), *epoch(2, 2.0), *epoch(0, 0.0), *epoch(1, 1.0)]
    save(tmp_path / 'bag', recording(messages))
    assert read(tmp_path / 'bag').messages == tuple(messages)


def test_an_empty_recording_can_be_saved(tmp_path):
    save(tmp_path / 'bag', recording([]))
    assert (tmp_path / 'bag' / 'metadata.yaml').is_file()


def test_numbers_of_a_packet_survive(tmp_path):
    odd = Rssi(START + 1, 65535, 65535, 2**32 - 1, 2**32 - 1, -0.1 - 0.2, math.pi, 65535)
    request = Request(START, 65535, 2**32 - 1)
    save(tmp_path / 'bag', recording([request, odd]))
    assert read(tmp_path / 'bag').messages == (request, odd)

"""Recordings from which packets got lost: what is left, what says so, and that nothing else changes."""

from collections import Counter
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import properties

from wsn_tracking.bags.read import read
from wsn_tracking.bags.save import save
from wsn_tracking.bags.thin import thin
from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation.run import epochs_of
from wsn_tracking.models.links import Loss
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.sensing.stage import SensingStage, TriggerConfig
from wsn_tracking.sensing.values import EpochEnd, Range, Reason, Request, Rssi, TriggerReport
from wsn_tracking.simulation.record import record
from wsn_tracking.simulation.scenarios import scenario

LOOP = record(scenario('a_loop'), 1)
MANY = Loss(0.5)


def arrived(recording, target=1):
    """Which nodes' packets a recording holds, (K, N) by request and node."""
    seqs = [m.seq for m in recording.messages if isinstance(m, Request) and m.target_id == target]
    ids = recording.anchors.ids.tolist()
    held = {(m.request_seq, m.node_id) for m in packets(recording) if m.target_id == target}
    return np.array([[(k, i) in held for i in ids] for k in seqs])


def packets(recording):
    return [m for m in recording.messages if isinstance(m, (Rssi, Range))]


def triggered():
    """The loop as ranges, of which some were never sent."""
    stage = SensingStage(TriggerConfig(), LOOP.anchors)
    messages = []
    for epoch in epochs_of(LOOP, 1, Counter()):
        sensed = stage.step(epoch)
        messages += [Request(epoch.stamp_ns, 1, epoch.request_seq), *sensed.ranges, sensed.report]
        sent = sensed.report.sent_ids, sensed.report.sent_seqs
        messages.append(EpochEnd(epoch.stamp_ns, 1, epoch.request_seq, 'range', *sent, epoch.request_seq == 119))
    return LOOP._replace(entry_level='range', messages=tuple(messages), metadata={'entry_level': 'range'})


def second_target(recording: Recording) -> Recording:
    """The same again, of target 2, message by message beside the first."""
    pairs = [(m, m._replace(target_id=2)) for m in recording.messages]
    return recording._replace(messages=tuple(m for pair in pairs for m in pair))


def whole_again(recording):
    """Closes every epoch by its lists, or raises where one lists what is not there."""
    return list(epochs_of(recording, 1, Counter()))


@pytest.mark.parametrize('loss', [MANY, Loss(0.9), Loss(0.5, 5.0), Loss(0.5, whole_round=True), Loss(1.0), Loss()])
@pytest.mark.parametrize('recording', [LOOP, triggered()], ids=['rssi', 'range'])
def test_every_epoch_is_left_and_its_lists_hold(recording, loss):
    thinned = thin(recording, loss, 3)
    epochs = whole_again(thinned)
    assert [(e.stamp_ns, e.request_seq) for e in epochs] == [
        (e.stamp_ns, e.request_seq) for e in whole_again(recording)
    ]
    assert sum(len(e.measurements) for e in epochs) == len(packets(thinned))
    assert thinned.truth is recording.truth


def test_nothing_lost_changes_nothing():
    assert thin(LOOP, Loss(), 3).messages == LOOP.messages
    assert not packets(thin(LOOP, Loss(1.0), 3))


@given(st.floats(0.0, 1.0), st.integers(0, 2**40))
@properties
def test_what_is_left_is_as_it_was_and_of_the_rate(rate, seed):
    """1440 packets: five standard deviations are at most 0.066."""
    left = packets(thin(LOOP, Loss(rate), seed))
    assert {*left} <= {*packets(LOOP)}
    assert len(left) / 1440 == pytest.approx(1.0 - rate, abs=0.067)


def test_more_loss_loses_the_same_and_more():
    held = [{*packets(thin(LOOP, Loss(rate), 3))} for rate in (0.1, 0.5, 0.9)]
    assert all(b < a for a, b in pairwise(held))


def test_rounds_are_lost_as_a_whole_and_bursts_last():
    rounds = arrived(thin(LOOP, Loss(0.5, whole_round=True), 3))
    assert np.all(rounds == rounds[:, :1])
    assert rounds[:, 0].mean() == pytest.approx(0.5, abs=0.2)
    lost = ~arrived(thin(LOOP, Loss(0.5, 10.0), 3))
    ends = np.sum(lost[:-1] & ~lost[1:]) + lost[-1].sum()
    assert lost.sum() / ends == pytest.approx(10.0, rel=0.35)  # 72 bursts, cut short at the end
    single = ~arrived(thin(LOOP, MANY, 3))
    assert single.sum() / (np.sum(single[:-1] & ~single[1:]) + single[-1].sum()) == pytest.approx(2.0, rel=0.15)


def test_a_link_does_not_depend_on_what_else_the_bag_holds():
    alone = arrived(thin(LOOP, MANY, 3))
    beside = thin(second_target(LOOP), MANY, 3)
    np.testing.assert_array_equal(arrived(beside), alone)
    assert not np.array_equal(arrived(beside, 2), alone)
    fewer = LOOP._replace(
        anchors=LOOP.anchors.select([3, 7]),
        messages=tuple(
            m._replace(node_ids=(3, 7), seqs=tuple(s for i, s in zip(m.node_ids, m.seqs, strict=True) if i in (3, 7)))
            if isinstance(m, EpochEnd)
            else m
            for m in LOOP.messages
            if not isinstance(m, Rssi) or m.node_id in (3, 7)
        ),
    )
    np.testing.assert_array_equal(arrived(thin(fewer, MANY, 3)), alone[:, [2, 6]])
    assert not np.array_equal(arrived(thin(LOOP, MANY, 4)), alone)


def test_a_lost_range_is_reported_as_not_heard():
    whole, thinned = triggered(), thin(triggered(), MANY, 3)
    reports = [[m for m in r.messages if isinstance(m, TriggerReport)] for r in (whole, thinned)]
    for before, after in zip(*reports, strict=True):
        assert {*after.sent_ids, *after.silent_ids} == {*before.sent_ids, *before.silent_ids}
        lost = dict(zip(after.silent_ids, after.reasons, strict=True))
        assert all(lost[i] == Reason.NOT_HEARD for i in {*before.sent_ids} - {*after.sent_ids})
    assert any(len(a.sent_ids) < len(b.sent_ids) for b, a in zip(*reports, strict=True))


def test_packets_without_lists_get_them():
    bare = LOOP._replace(messages=tuple(m for m in LOOP.messages if isinstance(m, Rssi)))
    np.testing.assert_array_equal(arrived(thin(bare, MANY, 3)), arrived(thin(LOOP, MANY, 3)))


def test_the_metadata_tell_what_was_done():
    told = thin(LOOP, Loss(0.5, 5.0, whole_round=True), 3).metadata
    assert {k: v for k, v in told.items() if k.startswith('loss')} == {
        'loss': '0.5', 'loss_burst': '5', 'loss_kind': 'round', 'loss_seed': '3'
    }  # fmt: skip
    assert told['configuration'] == 'random_q'
    assert 'loss_burst' not in thin(LOOP, MANY, 3).metadata


# ---- the command


def test_the_command_writes_a_bag_that_replays(call, tmp_path):
    save(tmp_path / 'loop', LOOP)
    words = ['--loss', 0.5, '--bursts', 4, '--round', '--seed', 7]
    ended = call('degrade', tmp_path / 'loop', *words, '-o', tmp_path / 'less')
    assert ended.code == 0
    back, expected = read(tmp_path / 'less'), thin(LOOP, Loss(0.5, 4.0, whole_round=True), 7)
    assert repr(back.messages) == repr(expected.messages)
    assert f'{len(packets(expected))} of 1440 readings are left' in ended.out


@pytest.mark.parametrize(
    ('arguments', 'code', 'words'),
    [
        (['--loss', '1.5'], 2, "'1.5': expected a share from 0 to 1"),
        (['--loss', 'half'], 2, "'half': expected a share"),
        (['--loss', 'nan'], 2, "'nan': expected a share"),
        (['--loss', '0.5', '--bursts', '0.5'], 2, 'expected a number of epochs, 1 or more'),
        (['--loss', '0.9', '--bursts', '2'], 1, 'already independent losses last 10 epochs in a row'),
    ],
)
def test_a_loss_that_cannot_be_is_refused(call, tmp_path, arguments, code, words):
    save(tmp_path / 'loop', LOOP)
    ended = call('degrade', tmp_path / 'loop', *arguments, '-o', tmp_path / 'less')
    assert ended.code == code
    assert words in ended.err
    assert not (tmp_path / 'less').exists()


def test_a_bag_is_not_overwritten(call, tmp_path):
    save(tmp_path / 'loop', LOOP)
    ended = call('degrade', tmp_path / 'loop', '--loss', 0.5, '-o', tmp_path / 'loop')
    assert ended.code == 1
    assert 'exists: name another folder or remove it' in ended.err
    assert repr(read(tmp_path / 'loop').messages) == repr(LOOP.messages)


def test_losses_of_no_chain_are_refused():
    with pytest.raises(TrackingError, match='bursts of 2 epochs'):
        thin(LOOP, Loss(0.9, 2.0), 1)

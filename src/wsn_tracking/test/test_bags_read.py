"""What is read of a bag: one namespace, one entry level, the last anchors, truth in order."""

from __future__ import annotations

import pytest
from bag_cases import NODES, SECOND, START, anchors, events, measurement, refused, write

from wsn_tracking.bags.messages import TruthPose, to_cdr
from wsn_tracking.bags.read import raw_messages, read
from wsn_tracking.bags.write import BagWriter
from wsn_tracking.sensing.values import EpochEnd, Range, Request, Rssi, TriggerReport


def test_one_namespace_is_read_and_several_must_be_chosen_from(tmp_path):
    one = write(tmp_path / 'one', events(), prefix='robot/')
    assert len(read(one).messages) == 25
    assert len(read(one, namespace='/robot').messages) == 25
    refused(one, 'nothing in namespace', "'/robot'", namespace='other')
    rows = [(f'{ns}/{topic}', value, t) for ns in ('a', 'a/b') for topic, value, t in events()]
    two = write(tmp_path / 'two', rows)
    refused(two, "['/a', '/a/b']", 'namespace')
    assert len(read(two, namespace='a/b').messages) == 25


def test_anchors_and_truth_may_stand_above_the_measurements(tmp_path):
    above = ('anchors', 'truth')
    rows = [(t if t.startswith(above) else f'robot/{t}', value, log) for t, value, log in events()]
    back = read(write(tmp_path / 'bag', rows))
    assert back.anchors.ids.tolist() == list(NODES)
    assert list(back.truth) == [1]


def test_the_last_anchors_count(tmp_path):
    moved = anchors()._replace(positions=anchors().positions + 1.0)
    rows = [*events(), ('anchors', moved, START + 99 * SECOND)]
    assert read(write(tmp_path / 'bag', rows)).anchors.positions.tolist() == moved.positions.tolist()


@pytest.mark.parametrize(('said', 'level'), [(None, 'rssi'), ('range', 'range'), ('observation', 'observation')])
def test_one_entry_level_is_read_and_the_others_are_counted(tmp_path, said, level):
    rows = events('rssi')
    extra = [('range', measurement('range', START, n, 0), START + 99) for n in NODES]
    extra += [('observation', measurement('observation', START, 1, 0), START + 99)]
    extra += [('trigger_report', TriggerReport(START, 1, 0, NODES, (0, 0, 0), (), ()), START + 99)]
    back = read(write(tmp_path / 'bag', rows + extra, {'entry_level': said} if said else {}))
    assert back.entry_level == back.metadata['entry_level'] == level
    counts = {'rssi': 15, 'range': 3, 'observation': 1}
    kept = [m for m in back.messages if isinstance(m, Rssi | Range) or type(m).__name__ == 'RangeBearing']
    assert len(kept) == counts[level]
    assert any(isinstance(m, TriggerReport) for m in back.messages) == (level == 'range')
    lost = sum(count for name, count in counts.items() if name != level) + (level != 'range')
    assert back.dropped == {'not_entry_level': lost}


def test_other_topics_do_not_matter(tmp_path):
    with BagWriter(tmp_path / 'bag', {}) as bag:
        for topic, value, t in events():
            bag.write(topic, value, t)
        pose = to_cdr(TruthPose(START, 1, (0.0, 0.0, 0.0)), START)
        bag.write_raw('odometry/human', 'nav_msgs/msg/Odometry', pose, START)
    assert len(read(tmp_path / 'bag').messages) == 25
    assert len(list(raw_messages(tmp_path / 'bag'))) == len(events()) + 1


def test_nan_and_absurd_values_are_kept(tmp_path):
    nan, big = float('nan'), 1e308
    rows = [
        *events(epochs=1),
        ('rssi', Rssi(START, 65535, 1, 9, 0, nan), START + 10),
        ('rssi', Rssi(START, 4, 1, 9, 0, big), START + 11),
    ]
    last = read(write(tmp_path / 'bag', rows)).messages
    assert any(m.node_id == 65535 and m.rssi_dbm != m.rssi_dbm for m in last if isinstance(m, Rssi))
    assert any(m.rssi_dbm == big for m in last if isinstance(m, Rssi))


def test_truth_is_ascending_and_without_what_is_no_position(tmp_path):
    bad = [
        ('truth/target_1', TruthPose(START, 1, (9.0, 9.0, 9.0)), START + 1),  # a second one at the same instant
        ('truth/target_1', TruthPose(START + 7, 1, (float('nan'), 0.0, 0.0)), START + 2),
        ('truth/target_1', TruthPose(START - SECOND, 1, (5.0, 5.0, 5.0)), START + 3),  # late in the log
    ]
    back = read(write(tmp_path / 'bag', [*events(), *bad]))
    truth = back.truth[1]
    assert truth.positions[0].tolist() == [5.0, 5.0, 5.0]
    assert truth.stamps_ns.size == 6
    assert back.dropped == {'truth_unusable': 2}


def test_no_truth_is_fine_and_no_anchors_is_not(tmp_path):
    bare = [row for row in events() if not row[0].startswith('truth')]
    assert read(write(tmp_path / 'blind', bare)).truth == {}
    refused(write(tmp_path / 'lost', [row for row in events() if row[0] != 'anchors']), 'holds no anchors')


def test_a_bag_in_which_nothing_was_heard_is_read(tmp_path):
    rows = [row for row in events() if row[0] not in ('rssi', 'epoch_end')]
    back = read(write(tmp_path / 'bag', rows, {'entry_level': 'rssi'}))
    assert {type(m) for m in back.messages} == {Request}
    refused(write(tmp_path / 'unsaid', rows), 'holds no measurements')


def test_epoch_ends_are_among_the_messages(tmp_path):
    back = read(write(tmp_path / 'bag', events()))
    assert [m.final for m in back.messages if isinstance(m, EpochEnd)] == [False] * 4 + [True]

"""Canonical bags, and what is said of a bag."""

from __future__ import annotations

import pytest
from bag_cases import SECOND, START, events, mcap_of, measurement, write

from wsn_tracking.bags.epochs import with_epoch_ends
from wsn_tracking.bags.info import describe
from wsn_tracking.bags.messages import to_cdr, type_of
from wsn_tracking.bags.read import raw_messages, read
from wsn_tracking.bags.rewrite import canonical
from wsn_tracking.bags.save import save
from wsn_tracking.bags.write import BagWriter
from wsn_tracking.errors import TrackingError
from wsn_tracking.sensing.recording import Recording


def recorded(path, rows, noise):
    """As the graph records: other log times each run, padding bytes of any content, topics interleaved."""
    with BagWriter(path, {'entry_level': 'rssi', 'seed': '3'}) as bag:
        for k, (topic, value, _) in enumerate(rows):
            cdr = to_cdr(value, START)
            bag.write_raw(topic, type_of(value), cdr + bytes([noise] * (-len(cdr) % 4)), START * 2 + k * noise)


def test_the_rewritten_bag_does_not_depend_on_the_run(tmp_path):
    rows = []
    for topic, value, t in events('rssi'):
        rows.append((topic, value, t))
        if topic == 'truth/target_1':
            rows.append(('truth/target_2', value._replace(target_id=2), t))
    swapped = list(rows)
    for k in range(1, len(rows) - 1, 7):  # topics of one stamp reach the recorder in any order
        if rows[k][0] != rows[k + 1][0] and rows[k][1].stamp_ns == rows[k + 1][1].stamp_ns:
            swapped[k], swapped[k + 1] = swapped[k + 1], swapped[k]
    assert swapped != rows
    assert [row[0] for row in swapped[1:3]] == ['truth/target_2', 'truth/target_1']
    for name, order, noise in (('a', rows, 3), ('b', swapped, 7)):
        recorded(tmp_path / name, order, noise)
        canonical(tmp_path / name, tmp_path / f'{name}2' / 'bag')
    assert mcap_of(tmp_path / 'a').read_bytes() != mcap_of(tmp_path / 'b').read_bytes()
    first, second = tmp_path / 'a2' / 'bag', tmp_path / 'b2' / 'bag'
    assert mcap_of(first).read_bytes() == mcap_of(second).read_bytes()
    assert (first / 'metadata.yaml').read_bytes() == (second / 'metadata.yaml').read_bytes()
    assert read(first).messages == read(tmp_path / 'a').messages
    assert read(first).metadata == {'entry_level': 'rssi', 'seed': '3'}


def test_padding_becomes_zero(tmp_path):
    rows = events('rssi', epochs=2)
    with BagWriter(tmp_path / 'bag', {}) as bag:
        for topic, value, t in rows:
            cdr = bytearray(to_cdr(value, t))
            if topic == 'request':
                assert cdr[22:24] == b'\x00\x00'  # between target_id and seq
                cdr[22:24] = b'\xaa\xbb'
            bag.write_raw(topic, type_of(value), bytes(cdr), t)
    canonical(tmp_path / 'bag', tmp_path / 'clean')
    dirty, clean = ([raw.cdr for raw in raw_messages(tmp_path / f)] for f in ('bag', 'clean'))
    assert any(b'\xaa\xbb' in cdr for cdr in dirty)
    assert not any(b'\xaa\xbb' in cdr for cdr in clean)
    assert read(tmp_path / 'clean').messages == read(tmp_path / 'bag').messages


def test_log_times_are_stamps_and_quality_of_service_stays(tmp_path):
    recorded(tmp_path / 'bag', events('rssi'), 5)
    canonical(tmp_path / 'bag', tmp_path / 'clean')
    back = list(raw_messages(tmp_path / 'clean'))
    assert sorted({raw.log_ns for raw in back}) == [START + k * SECOND for k in range(5)]
    assert [raw.topic for raw in back[:2]] == ['/anchors', '/truth/target_1']
    assert {raw.topic: raw.qos for raw in back} == {raw.topic: raw.qos for raw in raw_messages(tmp_path / 'bag')}


def test_derived_topics_are_left_out_unless_asked_for(tmp_path):
    rows = [*events('rssi'), ('range', measurement('range', START, 1, 0), START)]
    path = write(tmp_path / 'bag', rows, {'entry_level': 'rssi'})
    canonical(path, tmp_path / 'base')
    assert {raw.topic for raw in raw_messages(tmp_path / 'base')} == {
        '/anchors',
        '/truth/target_1',
        '/request',
        '/rssi',
        '/epoch_end',
    }
    canonical(path, tmp_path / 'some', keep=['rssi', 'range'])
    assert {raw.topic for raw in raw_messages(tmp_path / 'some')} == {'/rssi', '/range'}
    with pytest.raises(TrackingError, match='nothing to rewrite'):
        canonical(path, tmp_path / 'none', keep=['sound'])


def test_a_message_that_cannot_be_decoded_is_told(tmp_path):
    with BagWriter(tmp_path / 'bag', {}) as bag:
        for topic, value, t in events():
            bag.write(topic, value, t)
        bag.write_raw('rssi', 'wsn_tracking_msgs/msg/RssiMeasurement', b'\x00\x01\x00\x00', START)
    with pytest.raises(TrackingError, match='on /rssi cannot be decoded'):
        canonical(tmp_path / 'bag', tmp_path / 'clean')


@pytest.mark.parametrize('level', ['rssi', 'range', 'observation'])
def test_a_saved_recording_is_read_back_equal(tmp_path, level):
    original = read(write(tmp_path / 'bag', events(level), {'entry_level': level, 'area': '0 0 4 4'}))
    save(tmp_path / 'copy', original)
    back = read(tmp_path / 'copy')
    assert back.messages == original.messages
    assert back.metadata == original.metadata
    assert back.truth[1].positions.tolist() == original.truth[1].positions.tolist()


def test_info_says_what_the_bag_holds(tmp_path):
    path = write(tmp_path / 'bag', events('rssi'), {'entry_level': 'rssi', 'area': '0 0 4 4'})
    text = describe(read(path))
    lines = {line.split('  ')[0].strip(): line for line in text.splitlines()}
    assert 'rssi' in lines['entry level']
    assert '3 (1 2 7), x 0.00..3.50' in lines['anchors']
    assert '4.0 s' in lines['duration']
    assert '5 epochs, every 1.000 s, 15 measurements of 3 nodes' in lines['target 1']
    assert '5 positions over 4.0 s, x 0.00..0.40, y 1.00..1.00, z 1.80..1.80 m' in lines['truth 1']
    assert '0 0 4 4' in lines['area']
    assert 'nothing' in lines['dropped']


def test_info_counts_losses_and_survives_emptiness(tmp_path):
    whole = read(write(tmp_path / 'bag', events('rssi')))
    assert 'truncated 1' in describe(whole._replace(dropped={'truncated': 1}))
    empty = Recording(whole.anchors, 'rssi', (), {}, {}, {})
    assert 'no messages' in describe(empty)
    assert describe(with_epoch_ends(empty)) == describe(empty)

"""Types and definitions in a bag: another one is counted or refused, comments do not matter."""

from __future__ import annotations

from bag_cases import START, anchors, events, measurement, plain_mcap, refused, write

from wsn_tracking.bags.messages import to_cdr
from wsn_tracking.bags.read import raw_messages, read
from wsn_tracking.bags.types import definition, typestore
from wsn_tracking.bags.write import BagWriter


def test_a_wrong_type_beside_the_right_one_is_counted(tmp_path):
    rows = [*events(), ('x/rssi', measurement('range', START, 1, 0), START)]
    back = read(plain_mcap(tmp_path / 'x.mcap', rows))
    assert back.dropped == {'wrong_type': 1}


def test_a_topic_of_another_type_is_named(tmp_path):
    rows = [row for row in events() if row[0] != 'rssi' and row[0] != 'request' and row[0] != 'epoch_end']
    path = plain_mcap(tmp_path / 'x.mcap', [*rows, ('/rssi', measurement('range', START, 1, 0), START)])
    refused(path, 'holds no measurements', '/rssi (wsn_tracking_msgs/msg/RangeMeasurement)', 'wrong_type 1')


def test_bytes_of_another_type_are_counted(tmp_path):
    with BagWriter(tmp_path / 'bag', {}) as bag:
        for topic, value, t in events():
            bag.write(topic, value, t)
        bag.write_raw('rssi', 'wsn_tracking_msgs/msg/RssiMeasurement', b'', START)
        bag.write_raw('rssi', 'wsn_tracking_msgs/msg/RssiMeasurement', b'\x00\x01\x00\x00abc', START)
    back = read(tmp_path / 'bag')
    assert back.dropped == {'undecodable': 2}
    assert len(back.messages) == 25


def test_a_definition_with_other_fields_is_refused(tmp_path):
    name = 'wsn_tracking_msgs/msg/RssiMeasurement'
    old = definition(name).replace('float64 sigma_db\n', '')
    path = plain_mcap(tmp_path / 'x.mcap', events(), definitions={name: old})
    refused(path, name, "'sigma_db'", 'another version')
    retyped = definition(name).replace('float64 rssi_dbm', 'float32 rssi_dbm')
    refused(plain_mcap(tmp_path / 'y.mcap', events(), definitions={name: retyped}), name, 'of equal types')
    refused(plain_mcap(tmp_path / 'z.mcap', events(), definitions={name: 'float64 ]['}), name, 'cannot be read')


def test_a_definition_with_comments_or_none_is_accepted(tmp_path):
    name = 'wsn_tracking_msgs/msg/RssiMeasurement'
    commented = '# the radio\n' + definition(name).replace('float64 rssi_dbm', 'float64   rssi_dbm # [dBm]')
    assert len(read(plain_mcap(tmp_path / 'x.mcap', events(), definitions={name: commented})).messages) == 25
    assert len(read(plain_mcap(tmp_path / 'y.mcap', events(), definitions={name: ''})).messages) == 25


def test_ragged_anchors_are_refused(tmp_path):
    name = 'wsn_tracking_msgs/msg/Anchors'
    message = typestore().deserialize_cdr(to_cdr(anchors(), START), name)
    message.z = message.z[:1]
    path = write(tmp_path / 'bag', [row for row in events() if row[0] != 'anchors'])
    with BagWriter(tmp_path / 'ragged', {}) as bag:
        for raw in raw_messages(path):
            bag.write_raw(raw.topic, raw.type_name, raw.cdr, raw.log_ns)
        bag.write_raw('anchors', name, bytes(typestore().serialize_cdr(message, name)), START)
    refused(tmp_path / 'ragged', 'different length', "'z': 1")


def test_what_is_no_bag_is_refused(tmp_path):
    refused(tmp_path / 'nothing', 'does not exist')
    (tmp_path / 'folder').mkdir()
    refused(tmp_path / 'folder', 'holds no .mcap file')
    (tmp_path / 'folder' / 'x.db3').write_bytes(b'SQLite format 3')
    refused(tmp_path / 'folder', 'x.db3', 'ros2 bag convert')
    (tmp_path / 'empty.mcap').write_bytes(b'')
    refused(tmp_path / 'empty.mcap', 'is empty')
    (tmp_path / 'text.mcap').write_text('hello, this is no bag')
    refused(tmp_path / 'text.mcap', 'no MCAP file', 'hello', 'ros2 bag convert')
    (tmp_path / 'magic.mcap').write_bytes(b'\x89MCAP0\r\n')
    refused(tmp_path / 'magic.mcap', 'holds no measurements', 'truncated 1')
    refused(plain_mcap(tmp_path / 'none.mcap', []), 'holds no measurements', 'no topics')


def test_compressed_files_are_refused_with_the_way_out(tmp_path):
    path = write(tmp_path / 'bag', events())
    text = (path / 'metadata.yaml').read_text()
    (path / 'metadata.yaml').write_text(text.replace("compression_mode: ''", 'compression_mode: FILE'))
    refused(path, "'FILE'", 'ros2 bag convert')


def test_an_unknown_entry_level_is_refused(tmp_path):
    refused(write(tmp_path / 'bag', events(), {'entry_level': 'smell'}), "'smell'", 'rssi, range, observation')

"""What a bag may look like and is still read, and what is refused in one line."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from bag_cases import NODES, SECOND, START, anchors, events, mcap_of, measurement, write
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap.writer import CompressionType, IndexType, Writer

from wsn_tracking.bags.messages import TruthPose, to_cdr, type_of
from wsn_tracking.bags.read import load_metadata, raw_messages, read
from wsn_tracking.bags.types import definition
from wsn_tracking.bags.write import BagWriter
from wsn_tracking.errors import TrackingError
from wsn_tracking.sensing.values import EpochEnd, Range, Request, Rssi, TriggerReport


def refused(path, *parts, **options):
    """The bag is refused in one line that says all of `parts`."""
    with pytest.raises(TrackingError) as error:
        read(path, **options)
    text = str(error.value)
    assert '\n' not in text
    for part in parts:
        assert part in text


def plain_mcap(path: Path, rows, topics=None, definitions=None, **options) -> Path:
    """A bare file by the mcap library, with its options; `definitions` replaces a type's definition."""
    with path.open('wb') as stream:
        mcap = Writer(stream, **options)
        mcap.start(profile='ros2', library='test')
        channels = {}
        for topic, value, log_ns in rows:
            name = type_of(value)
            if topic not in channels:
                text = (definitions or {}).get(name, definition(name))
                schema = mcap.register_schema((topics or {}).get(topic, name), 'ros2msg' if text else '', text.encode())
                channels[topic] = mcap.register_channel(topic, 'cdr', schema)
            mcap.add_message(channels[topic], log_ns, to_cdr(value, log_ns), log_ns)
        mcap.finish()
    return path


def test_folder_and_file_are_the_same_recording(tmp_path):
    path = write(tmp_path / 'bag', events(), {'entry_level': 'rssi', 'area': '0 0 1 1'})
    folder, file = read(path), read(mcap_of(path))
    assert folder.messages == file.messages
    assert folder.metadata == file.metadata == {'entry_level': 'rssi', 'area': '0 0 1 1'}
    assert load_metadata(path) == folder.metadata


@pytest.mark.parametrize(
    'options',
    [
        {'compression': CompressionType.NONE},
        {'compression': CompressionType.LZ4},
        {'compression': CompressionType.ZSTD, 'chunk_size': 300},
        {'use_chunking': False},
        {'index_types': IndexType.NONE, 'repeat_channels': False, 'repeat_schemas': False},
        {'index_types': IndexType.NONE, 'use_statistics': False, 'use_summary_offsets': False},
        {'enable_crcs': False},
        {'enable_data_crcs': True},
    ],
    ids=str,
)
def test_every_layout_of_an_mcap_file_is_read(tmp_path, options):
    expected = read(write(tmp_path / 'bag', events('range')))
    back = read(plain_mcap(tmp_path / 'x.mcap', events('range'), **options))
    assert back.messages == expected.messages
    assert back.dropped == {}


def test_a_killed_recorder_loses_only_the_end(tmp_path):
    path = write(tmp_path / 'bag', events('rssi', epochs=2000))
    whole = read(path)
    data = mcap_of(path).read_bytes()
    (path / 'metadata.yaml').unlink()
    mcap_of(path).write_bytes(data[: len(data) * 6 // 10])
    cut = read(path)
    assert 0.3 * len(whole.messages) < len(cut.messages) < 0.9 * len(whole.messages)
    assert cut.messages == whole.messages[: len(cut.messages)]
    assert cut.dropped['truncated'] == 1
    assert cut.dropped['metadata_yaml'] == 1
    assert [raw.log_ns for raw in raw_messages(path)] == sorted(raw.log_ns for raw in raw_messages(path))


@pytest.mark.parametrize('compression', [CompressionType.NONE, CompressionType.ZSTD, CompressionType.LZ4])
def test_the_beginning_of_a_cut_chunk_is_read(tmp_path, compression):
    rows = events('rssi', epochs=4000)
    path = plain_mcap(tmp_path / 'x.mcap', rows, chunk_size=2**24, compression=compression, index_types=IndexType.NONE)
    whole = read(path)
    data = path.read_bytes()
    path.write_bytes(data[: len(data) // 2])
    cut = read(path)
    assert 0 < len(cut.messages) < len(whole.messages)
    assert cut.messages == whole.messages[: len(cut.messages)]
    assert cut.dropped == {'truncated': 1, 'damaged': 1}


def test_a_damaged_chunk_costs_only_itself(tmp_path):
    path = plain_mcap(tmp_path / 'x.mcap', events('rssi', epochs=400), chunk_size=4000)
    whole = read(path)
    with path.open('rb') as stream:
        chunk = make_reader(stream).get_summary().chunk_indexes[7]
    data = bytearray(path.read_bytes())
    data[chunk.chunk_start_offset + chunk.chunk_length // 2] ^= 0xFF
    path.write_bytes(data)
    back = read(path)
    assert back.dropped == {'damaged': 1}
    assert 0.8 * len(whole.messages) < len(back.messages) < len(whole.messages)


def test_log_order_counts_not_the_order_in_the_file(tmp_path):
    rows = events('rssi')
    path = write(tmp_path / 'bag', rows[:1] + rows[:0:-1])
    back = read(path)
    logs = [raw.log_ns for raw in raw_messages(path)]
    assert logs == sorted(logs)
    assert [m.seq for m in back.messages if isinstance(m, Request)] == [0, 1, 2, 3, 4]


def test_split_bags_are_one_recording(tmp_path):
    path = write(tmp_path / 'bag', events('rssi'))
    whole = read(path)
    rows = events('rssi')
    shutil.rmtree(path)
    path.mkdir()
    plain_mcap(path / 'bag_0.mcap', rows[:12])
    plain_mcap(path / 'bag_1.mcap', rows[12:])
    back = read(path)
    assert back.messages == whole.messages
    assert set(back.dropped) == {'metadata_yaml'}


def test_a_missing_part_is_counted(tmp_path):
    path = write(tmp_path / 'bag', events('rssi'))
    text = (path / 'metadata.yaml').read_text()
    (path / 'metadata.yaml').write_text(text.replace('  - bag_0.mcap', '  - bag_0.mcap\n  - bag_1.mcap'))
    assert read(path).dropped == {'missing_file': 1}


@pytest.mark.parametrize('text', ['', '[', 'a: b', '- 1', 'rosbag2_bagfile_information: 3', '\x00', '\xff' * 9])
def test_a_broken_metadata_file_hides_nothing(tmp_path, text):
    path = write(tmp_path / 'bag', events('rssi'), {'entry_level': 'rssi', 'area': '0 0 1 1'})
    (path / 'metadata.yaml').write_text(text, 'latin-1')
    back = read(path)
    assert back.dropped == {'metadata_yaml': 1}
    assert back.metadata['area'] == '0 0 1 1'


def test_metadata_never_leave_the_folder(tmp_path):
    path = write(tmp_path / 'bag', events('rssi'))
    write(tmp_path / 'other', events('rssi', epochs=50))
    text = (path / 'metadata.yaml').read_text()
    (path / 'metadata.yaml').write_text(text.replace('- bag_0.mcap', '- ../other/other_0.mcap'))
    assert len(read(path).messages) == 5 * 5


def test_namespaces(tmp_path):
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


def test_no_truth_is_fine_and_no_anchors_is_not(tmp_path):
    bare = [row for row in events() if not row[0].startswith('truth')]
    assert read(write(tmp_path / 'blind', bare)).truth == {}
    refused(write(tmp_path / 'lost', [row for row in events() if row[0] != 'anchors']), 'holds no anchors')


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


def test_ragged_anchors_are_refused(tmp_path):
    from wsn_tracking.bags.types import typestore

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
    refused(tmp_path / 'text.mcap', 'no MCAP file', 'hello')
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


def test_a_bag_in_which_nothing_was_heard_is_read(tmp_path):
    rows = [row for row in events() if row[0] not in ('rssi', 'epoch_end')]
    back = read(write(tmp_path / 'bag', rows, {'entry_level': 'rssi'}))
    assert {type(m) for m in back.messages} == {Request}
    refused(write(tmp_path / 'unsaid', rows), 'holds no measurements')


def test_epoch_ends_are_among_the_messages(tmp_path):
    back = read(write(tmp_path / 'bag', events()))
    assert [m.final for m in back.messages if isinstance(m, EpochEnd)] == [False] * 4 + [True]


@pytest.mark.parametrize('lie', [1, -9, 2**40])
def test_an_index_that_lies_changes_nothing(tmp_path, lie):
    path = plain_mcap(tmp_path / 'x.mcap', events('range', epochs=50), chunk_size=2000)
    whole = read(path)
    data = bytearray(path.read_bytes())
    at, lies = 8, 0
    while at < len(data) - 8:
        opcode, length = data[at], int.from_bytes(data[at + 1 : at + 9], 'little')
        if opcode == Opcode.MESSAGE_INDEX:
            offset = at + 9 + 6 + 8  # of the first message of this channel within the chunk
            told = int.from_bytes(data[offset : offset + 8], 'little') + lie
            data[offset : offset + 8] = max(told, 0).to_bytes(8, 'little')
            lies += 1
        at += 9 + length
    path.write_bytes(data)
    assert lies > 20
    assert read(path).messages == whole.messages

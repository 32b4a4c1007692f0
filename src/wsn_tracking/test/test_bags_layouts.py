"""Every layout of a bag is read, and of a damaged one all but what is damaged."""

from __future__ import annotations

import shutil

import pytest
from bag_cases import events, mcap_of, plain_mcap, write
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap.writer import CompressionType, IndexType

from wsn_tracking.bags.read import load_metadata, raw_messages, read
from wsn_tracking.sensing.values import Request


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


def test_log_order_counts_not_the_order_in_the_file(tmp_path):
    rows = events('rssi')
    path = write(tmp_path / 'bag', rows[:1] + rows[:0:-1])
    back = read(path)
    logs = [raw.log_ns for raw in raw_messages(path)]
    assert logs == sorted(logs)
    assert [m.seq for m in back.messages if isinstance(m, Request)] == [0, 1, 2, 3, 4]


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


# ---- damage


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

"""Whatever the bytes: a recording, or one line that says why not."""

from __future__ import annotations

import functools
import os
import tempfile
import threading
from pathlib import Path

import pytest
from bag_cases import events, mcap_of, write
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.writer import CompressionType, Writer

from wsn_tracking import files
from wsn_tracking.bags import write as writing
from wsn_tracking.bags.epochs import with_epoch_ends
from wsn_tracking.bags.info import describe
from wsn_tracking.bags.read import raw_messages, read
from wsn_tracking.errors import TrackingError
from wsn_tracking.sensing.recording import Recording

ROWS = events('range', epochs=3)


@functools.cache
def small_bag(kind: str) -> bytes:
    """The file of a small bag: as we write it, or such that damage is not seen by a checksum."""
    with tempfile.TemporaryDirectory() as folder, pytest.MonkeyPatch.context() as patch:
        patch.setattr(writing, 'CHUNK', 1500)
        if kind == 'bare':
            options = {'compression': CompressionType.NONE, 'enable_crcs': False, 'chunk_size': 1500}
            patch.setattr(writing, 'Writer', lambda stream, **_: Writer(stream, **options))
        return mcap_of(write(Path(folder) / 'bag', ROWS, {'entry_level': 'range'})).read_bytes()


def read_whatever(data: bytes) -> Recording | TrackingError:
    """Everything that a user does with a bag; only these two may come of it."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / 'x.mcap'
        path.write_bytes(data)
        try:
            recording: Recording | TrackingError = read(path)
            assert sum(1 for _ in raw_messages(path)) <= len(ROWS)
            describe(with_epoch_ends(recording))
        except TrackingError as refusal:
            recording = refusal
    if isinstance(recording, TrackingError):
        assert len(str(recording).splitlines()) == 1
    return recording


edits = st.lists(
    st.tuples(
        st.sampled_from(['flip', 'zero', 'ones', 'cut', 'insert']), st.floats(0, 1, exclude_max=True), st.integers(0, 7)
    ),
    min_size=1,
    max_size=12,
)


def edited(data: bytes, steps) -> bytes:
    out = bytearray(data)
    for kind, place, bit in steps:
        at = int(place * len(out))
        if kind == 'insert':
            out[at:at] = bytes([bit]) * (bit + 1)
        elif kind == 'cut':
            del out[at : at + bit * bit]
        elif out:
            out[at] = {'flip': out[at] ^ (1 << bit), 'zero': 0, 'ones': 255}[kind]
    return bytes(out)


@settings(max_examples=150)
@given(kind=st.sampled_from(['ours', 'bare']), steps=edits)
def test_mutated_bytes_give_a_recording_or_one_line(kind, steps):
    read_whatever(edited(small_bag(kind), steps))


@settings(max_examples=60)
@given(kind=st.sampled_from(['ours', 'bare']), share=st.floats(0, 1))
def test_a_truncated_file_gives_the_beginning_or_one_line(kind, share):
    data = small_bag(kind)
    whole = read_whatever(data)
    assert isinstance(whole, Recording)
    cut = read_whatever(data[: int(share * len(data))])
    if isinstance(cut, Recording):
        assert cut.messages == whole.messages[: len(cut.messages)]
        assert cut.dropped.get('truncated', 0) == (int(share * len(data)) < len(data))


@settings(max_examples=60)
@given(junk=st.binary(max_size=300), magic=st.booleans())
def test_junk_is_refused(junk, magic):
    assert isinstance(read_whatever(b'\x89MCAP0\r\n' * magic + junk), TrackingError)


@pytest.mark.parametrize('size', [2**31, 2**40, 2**62])
def test_a_chunk_that_claims_the_world_is_damaged(size):
    data = bytearray(small_bag('ours'))
    at = data.index(b'zstd') - 4 - 12  # uncompressed size stands before checksum and name of the compression
    data[at : at + 8] = size.to_bytes(8, 'little')
    back = read_whatever(bytes(data))
    if isinstance(back, Recording):
        assert back.dropped['damaged'] == 1
    else:
        assert 'damaged 1' in str(back)


def test_what_never_ends_is_refused(monkeypatch):
    monkeypatch.setattr(files, 'ENDLESS', 1000)
    with pytest.raises(TrackingError, match='/dev/zero does not end: a file is expected'):
        read(Path('/dev/zero'))


def test_a_pipe_is_read_to_its_end(tmp_path):
    """Such as a shell's <(...)."""
    pipe = tmp_path / 'pipe'
    os.mkfifo(pipe)
    writer = threading.Thread(target=pipe.write_bytes, args=(b'all of it',))
    writer.start()
    assert files.read_whole(pipe) == b'all of it'
    writer.join()

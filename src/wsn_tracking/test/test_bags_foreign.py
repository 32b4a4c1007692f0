"""Other readers find in our bags what we wrote: equal values, qualities of service, types."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from bag_cases import events, mcap_of, write
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader

from wsn_tracking.bags.folder import Qos
from wsn_tracking.bags.read import raw_messages, read
from wsn_tracking.bags.types import BASE_TYPES, ESTIMATE, PACKAGE, message_folder, type_hash
from wsn_tracking.sensing.values import Range, RangeBearing, Rssi


@pytest.mark.parametrize('level', ['rssi', 'range', 'observation'])
def test_rosbags_reads_equal_values(tmp_path, level):
    path = write(tmp_path / 'bag', events(level), {'entry_level': level, 'note': 'ä: "x"'})
    ours = [m for m in read(path).messages if type(m) in (Rssi, Range, RangeBearing)]
    with AnyReader([path]) as bag:
        chosen = [c for c in bag.connections if c.topic == f'/{level}']
        theirs = [bag.deserialize(raw, c.msgtype) for c, _, raw in bag.messages(chosen)]
        assert bag.message_count == len(events(level))
        hashes = {c.msgtype: c.digest for c in bag.connections}
    assert hashes == {name: type_hash(name) for name in hashes}
    assert len(theirs) == len(ours) == 15
    for a, b in zip(ours, theirs, strict=True):
        assert b.header.frame_id == 'map'
        assert a.stamp_ns == b.header.stamp.sec * 10**9 + b.header.stamp.nanosec
        for field in a._fields[1:]:
            np.testing.assert_array_equal(getattr(a, field), getattr(b, field))


@pytest.mark.parametrize('level', ['rssi', 'range', 'observation'])
def test_mcap_ros2_support_reads_equal_values(tmp_path, level):
    path = write(tmp_path / 'bag', events(level))
    ours = [m for m in read(path).messages if type(m) in (Rssi, Range, RangeBearing)]
    with mcap_of(path).open('rb') as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        theirs = [ros for _, _, _, ros in reader.iter_decoded_messages(topics=[f'/{level}'])]
        everything = sum(1 for _ in reader.iter_decoded_messages())
        summary = reader.get_summary()
        header = reader.get_header()
    assert everything == len(events(level)) == summary.statistics.message_count
    assert header.profile == 'ros2'
    for channel in summary.channels.values():
        assert set(channel.metadata) == {'offered_qos_profiles', 'topic_type_hash'}
    for a, b in zip(ours, theirs, strict=True):
        for field in a._fields[1:]:
            np.testing.assert_array_equal(getattr(a, field), getattr(b, field))


def test_quality_of_service_survives(tmp_path):
    path = write(tmp_path / 'bag', events())
    seen = {raw.topic: raw.qos for raw in raw_messages(path)}
    assert seen['/anchors'] == Qos(reliable=True, transient_local=True, depth=1)
    assert seen['/rssi'] == Qos(reliable=True, transient_local=False, depth=1000)
    with AnyReader([path]) as bag:
        offered = {c.topic: c.ext.offered_qos_profiles[0] for c in bag.connections}
    assert offered['/anchors'].durability.name == 'TRANSIENT_LOCAL'
    assert offered['/rssi'].durability.name == 'VOLATILE'
    assert {profile.reliability.name for profile in offered.values()} == {'RELIABLE'}


def test_type_hashes_equal_those_of_the_build():
    built = {path.stem: path for path in message_folder().glob('*.json')}
    if not built:
        for parent in Path(__file__).resolve().parents:
            for path in parent.glob(f'install*/**/share/{PACKAGE}/msg/*.json'):
                built[path.stem] = path
    assert built, 'the workspace is not built: there is nothing to compare with'
    for type_name in (*BASE_TYPES.values(), ESTIMATE):
        content = json.loads(built[type_name.rpartition('/')[2]].read_text())
        hashes = {entry['type_name']: entry['hash_string'] for entry in content['type_hashes']}
        assert type_hash(type_name) == hashes[type_name]

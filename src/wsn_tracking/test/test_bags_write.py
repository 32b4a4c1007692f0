"""A bag in the making survives whatever happens to its writer."""

from __future__ import annotations

from pathlib import Path

import pytest
from bag_cases import START, events, mcap_of, write

from wsn_tracking.bags import types
from wsn_tracking.bags.folder import Qos
from wsn_tracking.bags.read import raw_messages, read
from wsn_tracking.bags.write import BagWriter
from wsn_tracking.errors import TrackingError


def test_an_exception_leaves_a_readable_bag(tmp_path):
    def interrupted():
        with BagWriter(tmp_path / 'bag', {'entry_level': 'rssi'}) as bag:
            for topic, value, t in events()[:12]:
                bag.write(topic, value, t)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    back = read(tmp_path / 'bag')
    assert len(list(raw_messages(tmp_path / 'bag'))) == 12
    assert back.dropped == {}


def test_an_existing_folder_is_refused_untouched(tmp_path):
    path = write(tmp_path / 'bag', events())
    before = mcap_of(path).read_bytes()
    with pytest.raises(TrackingError, match='exists: name another'):
        BagWriter(path, {})
    assert mcap_of(path).read_bytes() == before


def test_a_place_that_cannot_be_written_is_named(tmp_path):
    (tmp_path / 'file').write_text('')
    with pytest.raises(TrackingError, match='cannot be written'):
        BagWriter(tmp_path / 'file' / 'bag', {})


@pytest.mark.skipif(not Path('/dev/full').exists(), reason='needs the device that is always full')
def test_a_full_disk_is_told_once(tmp_path, monkeypatch):
    real = Path.open

    def full(path, *args, **more):
        return real(Path('/dev/full'), 'wb') if path.suffix == '.mcap' else real(path, *args, **more)

    monkeypatch.setattr(Path, 'open', full)
    with pytest.raises(TrackingError, match='No space left'):
        write(tmp_path / 'bag', events(epochs=3000))


def test_a_closed_bag_takes_nothing_and_closes_twice(tmp_path):
    bag = BagWriter(tmp_path / 'bag', {})
    bag.write(*events()[0])
    bag.close()
    bag.close()
    with pytest.raises(TrackingError, match='is closed'):
        bag.write(*events()[1])


def test_a_value_on_the_wrong_topic_is_refused(tmp_path):
    with BagWriter(tmp_path / 'bag', {}) as bag:
        with pytest.raises(TrackingError, match=r"'range' was given wsn_tracking_msgs/msg/LocationRequest"):
            bag.write('range', events()[2][1], START)
        with pytest.raises(TrackingError, match="'sound' was given"):
            bag.write('sound', events()[2][1], START)


def test_an_unknown_type_is_refused(tmp_path):
    with BagWriter(tmp_path / 'bag', {}) as bag, pytest.raises(TrackingError, match='neither of'):
        bag.write_raw('x', 'other_msgs/msg/Thing', b'\x00\x01\x00\x00', START)


@pytest.mark.parametrize('log_ns', [-1, 2**63])
def test_a_log_time_out_of_range_is_refused(tmp_path, log_ns):
    with BagWriter(tmp_path / 'bag', {}) as bag, pytest.raises(TrackingError, match='log time'):
        bag.write(*events()[2][:2], log_ns)


def test_raw_messages_of_standard_types_pass_unchanged(tmp_path):
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_JAZZY)
    text = store.types['std_msgs/msg/String'](data='hello')
    cdr = bytes(store.serialize_cdr(text, 'std_msgs/msg/String'))
    best_effort = Qos(reliable=False, transient_local=False, depth=5)
    with BagWriter(tmp_path / 'bag', {}) as bag:
        bag.write_raw('/ns/text', 'std_msgs/msg/String', cdr, START, best_effort)
    (raw,) = raw_messages(tmp_path / 'bag')
    assert (raw.topic, raw.type_name, raw.cdr, raw.log_ns) == ('/ns/text', 'std_msgs/msg/String', cdr, START)
    assert raw.qos == best_effort


def test_an_empty_bag_has_metadata_too(tmp_path):
    BagWriter(tmp_path / 'bag', {'entry_level': 'rssi'}).close()
    assert 'message_count: 0' in (tmp_path / 'bag' / 'metadata.yaml').read_text()
    assert list(raw_messages(tmp_path / 'bag')) == []


def test_definitions_that_are_not_there_are_told(tmp_path, monkeypatch):
    monkeypatch.setattr(types, '_folders', lambda: iter([tmp_path]))
    with pytest.raises(TrackingError, match='build the workspace'):
        types.message_folder()


def test_definitions_are_taken_from_the_environment_first(tmp_path, monkeypatch):
    folder = tmp_path / 'share' / 'wsn_tracking_msgs' / 'msg'
    folder.mkdir(parents=True)
    (folder / 'Anchors.msg').write_text('uint16[] ids\n')
    monkeypatch.setenv('AMENT_PREFIX_PATH', f'/nowhere:{tmp_path}')
    assert types.message_folder() == folder
    with pytest.raises(TrackingError, match='lacks'):
        types.typestore.__wrapped__()
    (folder / 'Anchors.msg').write_text('][\n')
    with pytest.raises(TrackingError, match='cannot be used as a message definition'):
        types.typestore.__wrapped__()


@pytest.mark.parametrize(
    ('topic', 'namespace', 'name'),
    [
        ('rssi', '', 'rssi'),
        ('/rssi', '', 'rssi'),
        ('/a/b/rssi', 'a/b', 'rssi'),
        ('truth/target_1', '', 'truth/target_1'),
        ('/a/truth/target_1', 'a', 'truth/target_1'),
        ('/truth/other', 'truth', 'other'),
        ('/a/estimate/fused_1', 'a', 'estimate/fused_1'),
        ('', '', ''),
    ],
)
def test_topics_are_split_into_namespace_and_name(topic, namespace, name):
    assert types.split_topic(topic) == (namespace, name)


def test_targets_beyond_their_range_are_no_truth():
    assert types.truth_target('truth/target_65535') == 65535
    assert types.truth_target('truth/target_65536') is None
    assert types.truth_target('truth/target_x') is None

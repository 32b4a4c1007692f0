"""The folder round an MCAP file: metadata.yaml of rosbag2 (version 9), and quality of service in YAML."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from io import StringIO
from pathlib import Path
from typing import Any, NamedTuple

from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError

from wsn_tracking.bags.types import split_topic, type_hash
from wsn_tracking.errors import TrackingError

METADATA = 'metadata.yaml'
VERSION = 9
_INFORMATION = 'rosbag2_bagfile_information'
_FOREVER = {'sec': 9223372036, 'nsec': 854775807}


class Qos(NamedTuple):
    """What matters of a publisher's quality of service."""

    reliable: bool = True
    transient_local: bool = False
    depth: int = 1000


class BagFiles(NamedTuple):
    """What a path names."""

    files: tuple[Path, ...]
    custom: dict[str, str]  # custom_data of metadata.yaml
    dropped: dict[str, int]


class TopicCount(NamedTuple):
    """A line of metadata.yaml."""

    topic: str
    type_name: str
    qos: Qos
    messages: int


def default_qos(topic: str) -> Qos:
    """The quality of service that architecture.md gives a topic."""
    name = split_topic(topic).name
    if name == 'anchors':
        return Qos(transient_local=True, depth=1)
    return Qos(depth=200) if name.startswith('estimate/') else Qos()


def dump_qos(qos: Qos) -> list[dict[str, Any]]:
    """One profile as rosbag2 of Jazzy writes it."""
    return [
        {
            'history': 'keep_last',
            'depth': qos.depth,
            'reliability': 'reliable' if qos.reliable else 'best_effort',
            'durability': 'transient_local' if qos.transient_local else 'volatile',
            'deadline': dict(_FOREVER),
            'lifespan': dict(_FOREVER),
            'liveliness': 'automatic',
            'liveliness_lease_duration': dict(_FOREVER),
            'avoid_ros_namespace_conventions': False,
        }
    ]


def parse_qos(text: str, default: Qos) -> Qos:
    """The first of the profiles in a channel's YAML; `default` where there is none or it makes no sense.

    Enumerations are names in Jazzy and numbers before it.
    """
    try:
        profile = load_yaml(text)[0]
        depth = int(profile['depth'])
        return Qos(
            reliable=profile['reliability'] not in ('best_effort', 2),
            transient_local=profile['durability'] in ('transient_local', 1),
            depth=depth if 0 < depth <= 100_000 else default.depth,
        )
    except (TrackingError, KeyError, IndexError, TypeError, ValueError):
        return default


def dump_yaml(data: Any) -> str:
    """Block style, as rosbag2 writes it."""
    stream = StringIO()
    yaml = YAML(typ='safe', pure=True)
    yaml.default_flow_style = False
    yaml.allow_unicode = True
    yaml.width = 1000
    yaml.dump(data, stream)
    return stream.getvalue()


def load_yaml(text: str) -> Any:
    """Plain data; whatever the parser stumbles over is a TrackingError."""
    try:
        return YAML(typ='safe').load(text)
    except (YAMLError, ValueError, TypeError, KeyError, IndexError, AttributeError, RecursionError) as error:
        raise TrackingError(f'not YAML: {str(error).splitlines()[0]}') from error


def information(
    file: str, span: tuple[int, int], topics: Sequence[TopicCount], custom: Mapping[str, str]
) -> dict[str, Any]:
    """Content of metadata.yaml for one file whose messages lie between span[0] and span[1] [ns]."""
    start = {'nanoseconds_since_epoch': span[0]}
    duration = {'nanoseconds': span[1] - span[0]}
    count = sum(topic.messages for topic in topics)
    return {
        'version': VERSION,
        'storage_identifier': 'mcap',
        'duration': dict(duration),
        'starting_time': dict(start),
        'message_count': count,
        'topics_with_message_count': [
            {
                'topic_metadata': {
                    'name': topic.topic,
                    'type': topic.type_name,
                    'serialization_format': 'cdr',
                    'offered_qos_profiles': dump_qos(topic.qos),
                    'type_description_hash': type_hash(topic.type_name),
                },
                'message_count': topic.messages,
            }
            for topic in topics
        ],
        'compression_format': '',
        'compression_mode': '',
        'relative_file_paths': [file],
        'files': [{'path': file, 'starting_time': start, 'duration': duration, 'message_count': count}],
        'custom_data': dict(custom) or None,
        'ros_distro': 'jazzy',
    }


def metadata_yaml(content: Mapping[str, Any]) -> str:
    """Text of metadata.yaml."""
    return dump_yaml({_INFORMATION: dict(content)})


def bag_files(path: Path) -> BagFiles:
    """The MCAP files of a bag: of a folder those that metadata.yaml names, else those that lie in it."""
    if not path.exists():
        raise TrackingError(f'{path} does not exist: a rosbag2 folder or an .mcap file is expected')
    if not path.is_dir():
        return BagFiles((path,), {}, {})
    lying = tuple(sorted(path.glob('*.mcap')))
    try:
        named, custom = _read_metadata(path / METADATA)
    except FileNotFoundError:  # the recorder was killed
        named, custom, broken = (), {}, 1
    except (OSError, ValueError, TypeError, KeyError, AttributeError):
        named, custom, broken = (), {}, 1
    else:
        broken = 0
    files = tuple(path / name for name in named if (path / name).exists()) or lying
    if not files:
        seen = sorted(entry.name for entry in path.iterdir())[:5]
        raise TrackingError(
            f'{path} holds no .mcap file but {seen}: a rosbag2 folder with storage mcap is expected; '
            'other storages are converted by `ros2 bag convert`'
        )
    absent = sum(not (path / name).exists() for name in named)
    dropped = {'metadata_yaml': broken, 'missing_file': absent}
    return BagFiles(files, custom, {reason: count for reason, count in dropped.items() if count})


def _read_metadata(path: Path) -> tuple[tuple[str, ...], dict[str, str]]:
    text = path.read_text('utf-8')
    try:
        content = load_yaml(text)[_INFORMATION]
    except TrackingError as error:
        raise ValueError(str(error)) from error
    if content.get('compression_mode'):
        raise TrackingError(
            f'{path} says compression_mode {content["compression_mode"]!r}: only compression within the MCAP '
            'file is read; convert the bag by `ros2 bag convert`'
        )
    names = tuple(Path(name).name for name in content['relative_file_paths'])  # never outside the folder
    custom = {str(key): str(value) for key, value in (content.get('custom_data') or {}).items()}
    return names, custom

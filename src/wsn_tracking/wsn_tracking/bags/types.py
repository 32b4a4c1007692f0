"""Message definitions and topics: what a bag holds under which name, and how a value becomes bytes' type.

The definitions of our own messages are the `.msg` files themselves, found beside the installed package or in
the workspace; everything standard comes from the typestore of ROS 2 Jazzy that rosbags carries. So nothing
here needs a running ROS.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

from rosbags.typesys import Stores, TypesysError, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from wsn_tracking.errors import TrackingError

PACKAGE = 'wsn_tracking_msgs'
ODOMETRY = 'nav_msgs/msg/Odometry'
ESTIMATE = f'{PACKAGE}/msg/TargetEstimate'
BASE_TYPES = {  # topic -> type of everything that a replay needs
    'request': f'{PACKAGE}/msg/LocationRequest',
    'rssi': f'{PACKAGE}/msg/RssiMeasurement',
    'range': f'{PACKAGE}/msg/RangeMeasurement',
    'observation': f'{PACKAGE}/msg/RangeBearing',
    'epoch_end': f'{PACKAGE}/msg/EpochEnd',
    'trigger_report': f'{PACKAGE}/msg/TriggerReport',
    'anchors': f'{PACKAGE}/msg/Anchors',
}
ENTRY_LEVELS = ('rssi', 'range', 'observation')  # the earlier is preferred where a bag holds several
_RELATIVE = re.compile(r'(?:(.*?)/)??(truth/target_\d+|estimate/[^/]+|[^/]+)', re.DOTALL)


class Topic(NamedTuple):
    """Name of a topic, split: '/robot/truth/target_1' is 'truth/target_1' in namespace 'robot'."""

    namespace: str  # without leading or trailing '/'
    name: str


def split_topic(topic: str) -> Topic:
    """Split an absolute or relative topic name into namespace and the part that says what it is."""
    match = _RELATIVE.fullmatch(topic.strip('/'))
    return Topic((match[1] or '').strip('/'), match[2]) if match else Topic('', topic)


def expected_type(name: str) -> str | None:
    """Message type of a topic by its relative name; None: not a topic of ours."""
    if name.startswith('truth/target_'):
        return ODOMETRY
    if name.startswith('estimate/'):
        return ESTIMATE
    return BASE_TYPES.get(name)


def truth_target(name: str) -> int | None:
    """Target id of a truth topic by its relative name; None: another topic, or an id beyond uint16."""
    match = re.fullmatch(r'truth/target_([0-9]{1,5})', name)
    return int(match[1]) if match and int(match[1]) <= 65535 else None


def _folders() -> Iterator[Path]:
    """Where the definitions may be, most specific first."""
    for prefix in os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep):
        if prefix:
            yield Path(prefix) / 'share' / PACKAGE / 'msg'
    for parent in Path(__file__).resolve().parents:
        yield parent / PACKAGE / 'msg'  # sources of the workspace
        yield parent / 'share' / PACKAGE / 'msg'  # merged install
        yield parent / PACKAGE / 'share' / PACKAGE / 'msg'  # isolated install


def message_folder() -> Path:
    """The folder of our `.msg` files."""
    for folder in _folders():
        if any(folder.glob('*.msg')):
            return folder
    raise TrackingError(
        f'no message definitions: share/{PACKAGE}/msg is in no folder of AMENT_PREFIX_PATH nor beside this '
        'package; build the workspace and source its setup file'
    )


@cache
def typestore() -> Typestore:
    """ROS 2 Jazzy's standard types and ours. One store a process: it generates its code once."""
    store = get_typestore(Stores.ROS2_JAZZY)
    definitions = {}
    for path in sorted(message_folder().glob('*.msg')):
        try:
            definitions.update(get_types_from_msg(path.read_text('utf-8'), f'{PACKAGE}/msg/{path.stem}'))
        except (OSError, ValueError, TypesysError) as error:
            raise TrackingError(f'{path} cannot be used as a message definition: {error}') from error
    missing = {name for name in (*BASE_TYPES.values(), ESTIMATE) if name not in definitions}
    if missing:
        raise TrackingError(f'{message_folder()} lacks {sorted(missing)}: build {PACKAGE} anew')
    store.register(definitions)
    return store


@cache
def definition(type_name: str) -> str:
    """Text of a type in ros2msg form, all it depends on appended, as a bag embeds it."""
    if type_name not in typestore().fielddefs:
        raise TrackingError(
            f'message type {type_name!r} is neither of {PACKAGE} nor of ROS 2 Jazzy: it cannot be recorded'
        )
    return typestore().generate_msgdef(type_name, ros_version=2)[0]


@cache
def type_hash(type_name: str) -> str:
    """REP-2011 hash of a type (RIHS01), equal to the one that the build generates."""
    definition(type_name)  # refuses unknown types
    return typestore().hash_rihs01(type_name)

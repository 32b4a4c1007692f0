"""The files that viewers load, and what is in them: RViz displays, Foxglove panels and the topics that they name."""

from __future__ import annotations

import importlib
import json
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import yaml
from rclpy.qos import DurabilityPolicy, ReliabilityPolicy

import live

RVIZ = live.ROOT / 'src' / 'wsn_tracking' / 'rviz'
FOXGLOVE = live.ROOT / 'docs' / 'foxglove'
KINDS = {
    'rviz_default_plugins/MarkerArray': 'visualization_msgs/msg/MarkerArray',
    'rviz_default_plugins/Odometry': 'nav_msgs/msg/Odometry',
}


def rviz_displays(path: Path) -> tuple[Any, list[Any]]:
    """The whole file, and its displays of topics."""
    content = yaml.safe_load(path.read_text('utf-8'))
    return content, [d for d in content['Visualization Manager']['Displays'] if 'Topic' in d]


def offered(node: Any) -> dict[str, SimpleNamespace]:
    """Kinds of messages and qualities of service of every topic that a node sees."""
    return {
        name: SimpleNamespace(kinds=kinds, offers=[one.qos_profile for one in node.get_publishers_info_by_topic(name)])
        for name, kinds in node.get_topic_names_and_types()
    }


def check_rviz_topics(path: Path, topics: Mapping[str, Any]) -> None:
    """A reliable subscriber hears nothing of a best-effort publisher, nor one that wants the past of a volatile one."""
    for display in rviz_displays(path)[1]:
        asked = display['Topic']
        there = topics['/' + asked['Value']]
        assert there.kinds == [KINDS[display['Class']]]
        for offer in there.offers:
            if asked['Reliability Policy'] == 'Reliable':
                assert offer.reliability == ReliabilityPolicy.RELIABLE
            if asked['Durability Policy'] == 'Transient Local':
                assert offer.durability == DurabilityPolicy.TRANSIENT_LOCAL


def check_namespaces(rviz: Path, foxglove: Path, fixed: set[str], moving: set[str]) -> None:
    """Both viewers name the namespaces of markers that are published, and show the same of them."""
    nodes, markers = (d['Namespaces'] for d in rviz_displays(rviz)[1][:2])
    assert (set(nodes), set(markers)) == (fixed, moving)
    topics = layout(foxglove)['configById']['3D!map']['topics']
    assert set(topics['/anchor_markers']['namespaces']) == fixed
    assert {name: one['visible'] for name, one in topics['/markers']['namespaces'].items()} == markers


def layout(path: Path) -> Any:
    """A Foxglove layout."""
    return json.loads(path.read_text('utf-8'))


def placed(whole: Any, node: Any) -> Iterator[str]:
    """Panels of a layout tree, tabs opened."""
    if isinstance(node, str):
        yield node
        for tab in whole['configById'][node].get('tabs', ()):
            yield from placed(whole, tab['layout'])
    else:
        assert node['direction'] in {'row', 'column'}
        yield from placed(whole, node['first'])
        yield from placed(whole, node['second'])


def paths(value: Any) -> Iterator[str]:
    """Topics and message paths in a layout."""
    if isinstance(value, dict):
        for key, inner in value.items():
            if key in {'topicToRender', 'topicPath'} or (key == 'value' and isinstance(inner, str)):
                yield inner
            elif key == 'topics':
                yield from inner
            else:
                yield from paths(inner)
    elif isinstance(value, list):
        for inner in value:
            yield from paths(inner)


def check_foxglove_paths(path: Path, topics: Mapping[str, Any]) -> None:
    """Every path leads through a message that is published."""
    every = list(paths(layout(path)))
    assert len(every) > 10
    for one in every:
        topic, *fields = re.sub(r'\{.*?\}|\[[-:\d]*\]', '', one).split('.')
        (kind,) = topics[topic].kinds
        for field in fields:
            package, _, name = kind.rpartition('/')
            message = getattr(importlib.import_module(f'{package.partition("/")[0]}.msg'), name)
            kind = re.sub(r'sequence<(.*?)>', r'\1', message.get_fields_and_field_types()[field])

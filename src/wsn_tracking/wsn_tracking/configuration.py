"""The parameters of every executable, and configuration files that set them.

A file is a ROS 2 parameter file: section `/**` is for every node, `/**/NAME` for one. The same file serves
`ros2 run --params-file`, the launch files and the evaluator.
"""

from __future__ import annotations

import difflib
import os
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from wsn_tracking.errors import TrackingError
from wsn_tracking.parameters import group, param, specs
from wsn_tracking.sensing.stage import TriggerConfig
from wsn_tracking.trackers.consensus_config import ConsensusConfig
from wsn_tracking.trackers.estimator import EstimatorConfig
from wsn_tracking.trackers.fusing import FusionConfig
from wsn_tracking.zstack.clock import ClockConfig
from wsn_tracking.zstack.settings import LinkConfig
from wsn_tracking.zstack.simulator_settings import SimulatorConfig

Values = Mapping[str, Any]  # dotted parameter name -> value


@dataclass(frozen=True)
class NodeConfig:
    """Every node: when it says that it is ready, and when that its data has stopped."""

    expected_subscribers: tuple[str, ...] = param(
        ('',), 'for each output that others wait for, topic=count; set by launch files'
    )
    expected_publishers: tuple[str, ...] = param(('',), 'for each input, topic=count; set by launch files')
    silence_timeout: float = param(
        5.0, 'requests that stop for longer before the feed has ended are an error', 's', 1e-2
    )


@dataclass(frozen=True)
class AssemblyConfig:
    """How a node collects the messages of an epoch."""

    target_id: int = param(-1, 'the target that is tracked; -1: the first that is heard', 'id', -1, 65535)
    loss_timeout: float = param(1.0, 'steady time after which a listed message counts as lost', 's', 1e-3, 3600.0)
    lossless: bool = param(False, 'set in replay: a message that is missing is an error')


@dataclass(frozen=True)
class SensingNodeConfig(AssemblyConfig):
    """sensing_node."""

    ids: tuple[int, ...] = param((), 'the sensing nodes that live in this process; empty: all anchors', 'id', 0, 65535)
    seed: int = param(0, 'of the random trigger; the draw is keyed by seed, node and epoch', '', 0)
    channel: str = param('', 'file of `calibrate` that ranges are inverted with; empty: the anchors tell')
    trigger: TriggerConfig = group(TriggerConfig)


@dataclass(frozen=True)
class EstimatorNodeConfig(EstimatorConfig, AssemblyConfig):
    """estimator_node."""

    fusion_timeout: float = param(
        0.2, 'how long the fusion of an epoch waits for live peers (0.2 T)', 's', 1e-3, 3600.0
    )


@dataclass(frozen=True)
class ConsensusNodeConfig(ConsensusConfig, AssemblyConfig):
    """consensus_node."""

    ids: tuple[int, ...] = param((), 'the nodes that live in this process; empty: all anchors', 'id', 0, 65535)
    neighbours: tuple[int, ...] = param(
        (), 'whose shares the one node in `ids` takes; empty: those within `radius`', 'id', 0, 65535
    )
    input: str = param(
        'auto',
        'what is taken; auto: observation or range, whatever there is',
        choices=('auto', 'observation', 'range', 'rssi'),
    )
    period: float = param(1.0, 'T, time between requests of a target', 's', 1e-3, 3600.0)
    round_timeout: float = param(
        0.0, 'how long a round may last, on the average of those so far; 0: 0.6 T / `rounds`', 's', 0.0, 3600.0
    )

    @property
    def longest_round(self) -> float:
        """The round timeout that counts [s]."""
        return self.round_timeout or 0.6 * self.period / max(self.rounds, 1)

    def checked(self) -> ConsensusNodeConfig:
        """Itself, or TrackingError where fields contradict each other."""
        super().checked()
        if self.neighbours and len(self.ids) != 1:
            raise TrackingError(
                f'`neighbours` {list(self.neighbours)} are of one node, but `ids` names {list(self.ids) or "none"}: '
                'set `ids` to that node, or leave `neighbours` empty and set `radius`'
            )
        return self


@dataclass(frozen=True)
class FeedConfig:
    """How world_node and bag_player_node feed a graph."""

    rate: float = param(1.0, 'speed, as a multiple of real time; 0: as fast as the outputs keep up', '', 0.0, 1e6)
    expected_nodes: tuple[str, ...] = param(
        ('',), 'names of the nodes that must be ready before anything is sent; empty: none'
    )
    window_topics: tuple[str, ...] = param(('',), 'outputs that the feed stays close to')
    window: int = param(4, 'epochs that the feed may be ahead of those outputs', '', 1, 100000)
    output_timeout: float = param(5.0, 'an output silent for so long leaves the window', 's', 1e-2, 3600.0)
    progress: bool = param(False, 'draw a progress bar on the terminal')
    ready_timeout: float = param(60.0, 'how long nodes may take to be ready', 's', 1e-2, 86400.0)


@dataclass(frozen=True)
class PlayerConfig(FeedConfig):
    """bag_player_node."""

    bag: str = param('', 'bag to play: a rosbag2 folder or an .mcap file')
    namespace: str = param('', 'namespace in the bag, where it holds several')
    target_id: int = param(-1, 'the one target whose messages are played; -1: all', 'id', -1, 65535)


@dataclass(frozen=True)
class WorldConfig(FeedConfig):
    """world_node."""

    scenario: str = param('a_loop', 'experiment to simulate')
    seed: int = param(0, 'of the radio noise, and of a walk that is drawn', '', 0)
    start_stamp: float = param(0.0, 'stamp of the first epoch since 1970; 0: now', 's', 0.0, 4e9)


@dataclass(frozen=True)
class RecorderConfig:
    """bag_recorder_node."""

    output: str = param('recording', 'folder to write; it must not exist')
    entry_level: str = param(
        'rssi', 'the one level of measurements that is recorded', choices=('rssi', 'range', 'observation')
    )
    targets: tuple[int, ...] = param((1,), 'targets whose truth is recorded', 'id', 0, 65535)
    extra_topics: tuple[str, ...] = param(('',), 'derived topics that are recorded as well, e.g. estimate/fused_1')
    metadata: tuple[str, ...] = param(('',), 'key=value entries for the metadata of the bag')
    silence: float = param(1.0, 'after the final epoch: silence that ends the recording', 's', 1e-2, 3600.0)


@dataclass(frozen=True)
class EvaluatorConfig:
    """evaluator_node."""

    outputs: tuple[str, ...] = param(
        ('local_1', 'local_2', 'local_3', 'fused_1', 'fused_2', 'fused_3'), 'estimates that are scored'
    )
    target_id: int = param(1, 'target that is scored', 'id', 0, 65535)
    title: str = param('live', 'heading of the table')
    skip: float = param(5.0, 'errors before this time after the first epoch are not scored', 's', 0.0, 1e9)
    json: str = param('', 'file that the scores are written to; empty: none')
    plot: str = param('', 'folder that the plots are drawn in; empty: none')
    expected_reports: tuple[str, ...] = param(('',), 'nodes whose final counts go into the table')
    output_timeout: float = param(5.0, 'after the final epoch: an output silent for so long is given up', 's', 1e-2)
    fusion: FusionConfig = group(FusionConfig)


@dataclass(frozen=True)
class MarkerConfig:
    """marker_node."""

    outputs: tuple[str, ...] = param(('',), 'estimates that are drawn; empty: all that are published')
    track_length: int = param(200, 'epochs of a track that are drawn', '', 2, 100000)
    redraw_rate: float = param(5.0, 'at most so many arrays of markers a second', 'Hz', 0.01, 100.0)
    marker_size: float = param(0.0, 'diameter of a node; 0: from the extent of all of them', 'm', 0.0, 1000.0)
    target_height: float = param(0.0, 'height at which estimates are drawn', 'm', -1e4, 1e4)


@dataclass(frozen=True)
class AnchorsConfig:
    """The table of nodes that a bridge publishes; columns of one entry are for every node."""

    ids: tuple[int, ...] = param((), 'node ids; empty: somebody else publishes `anchors`', 'id', 0, 65535)
    x: tuple[float, ...] = param((), 'positions', 'm')
    y: tuple[float, ...] = param((), 'positions', 'm')
    z: tuple[float, ...] = param((0.0,), 'heights', 'm')
    p1_dbm: tuple[float, ...] = param((-45.0,), 'signal strength at 1 m', 'dBm')
    n: tuple[float, ...] = param((3.0,), 'path loss exponent', '', 0.1, 10.0)
    sigma_db: tuple[float, ...] = param((1.56,), 'standard deviation of the signal strength', 'dB', 0.01, 100.0)


@dataclass(frozen=True)
class SerialBridgeConfig(LinkConfig, ClockConfig):
    """serial_bridge_node."""

    period: float = param(1.0, 'T, time between requests of a target', 's', 1e-3, 3600.0)
    epoch_timeout: float = param(0.0, 'after the first word of an epoch until its EpochEnd; 0: 0.4 T', 's', 0.0, 3600.0)
    node_map: tuple[str, ...] = param(('',), 'radio=node, where a radio bears another id than its node; empty: none')
    range_modality: int = param(3, 'what measures ranges: 2 UWB, 3 ultrasound, 4 other', '', 1, 4)
    feedback: bool = param(False, 'send the estimates on `feedback` to the robots')
    feedback_address: int = param(0xFFFF, 'network address that feedback is sent to; 65535: all', '', 0, 0xFFFF)
    sensing_command: bool = param(False, 'send the commands on `sensing_command` to the sensing nodes')
    topology_period: float = param(30.0, 'how often the sink is asked for its neighbours; 0: never', 's', 0.0, 86400.0)
    anchors: AnchorsConfig = group(AnchorsConfig)


@dataclass(frozen=True)
class SinkSimulatorConfig(SimulatorConfig):
    """sink_simulator."""

    scenario: str = param('a_loop', 'experiment behind the sink')
    bag: str = param('', 'bag behind the sink, in the place of a scenario')
    target_id: int = param(-1, 'the one target that is there; -1: all', 'id', -1, 65535)
    expected_nodes: tuple[str, ...] = param(
        ('',), 'names of the nodes that must be ready before the nodes speak; empty: none'
    )
    publish_anchors: bool = param(True, 'publish the table of nodes, for a bridge that has none')
    linger: float = param(5.0, 'how long it stays after the last message; 0: until it is ended', 's', 0.0, 1e9)


EXECUTABLES: Mapping[str, type[Any]] = {
    'sensing_node': SensingNodeConfig,
    'serial_bridge_node': SerialBridgeConfig,
    'sink_simulator': SinkSimulatorConfig,
    'estimator_node': EstimatorNodeConfig,
    'consensus_node': ConsensusNodeConfig,
    'world_node': WorldConfig,
    'bag_player_node': PlayerConfig,
    'bag_recorder_node': RecorderConfig,
    'evaluator_node': EvaluatorConfig,
    'marker_node': MarkerConfig,
}


def share_folders(*parts: str) -> Iterator[Path]:
    """Where installed data of this package may be, most specific first; the sources come last."""
    for prefix in filter(None, os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep)):
        yield Path(prefix, 'share', 'wsn_tracking', *parts)
    yield Path(__file__).resolve().parents[1].joinpath(*parts)


def configuration_names() -> list[str]:
    """Configurations that come with the package."""
    return sorted({path.stem for folder in share_folders('config') for path in folder.glob('*.yaml')})


def find_configuration(name: str) -> Path:
    """The file of a configuration, by path or by the name of one that comes with the package."""
    candidates = [Path(name), *(folder / f'{name}.yaml' for folder in share_folders('config'))]
    for path in candidates:
        if os.path.isfile(path):  # noqa: PTH113 (pathlib raises where a name is too long)
            return path
    raise TrackingError(
        f'no configuration `{name}`: expected a file or one of {", ".join(configuration_names()) or "(none found)"}'
    )


class Configuration:
    """The sections of a parameter file."""

    def __init__(self, sections: Mapping[str, Values]) -> None:
        self._sections = sections

    def of(self, node: str) -> dict[str, Any]:
        """The parameters that the file sets for a node of that name."""
        values: dict[str, Any] = {}
        for section in ('/**', f'/**/{node}', f'/{node}', node):
            values.update(self._sections.get(section, {}))
        return values

    def check_sections(self, nodes: Collection[str]) -> None:
        """Raise TrackingError for a section that is of none of these nodes: it would have no effect."""
        for section in self._sections:
            name = section.rpartition('/')[2]
            if section != '/**' and name not in nodes:
                near = difflib.get_close_matches(name, nodes, 1)
                hint = f'did you mean `{near[0]}`?' if near else f'expected one of {", ".join(sorted(nodes))}'
                raise TrackingError(f'section `{section}` is of no node of this graph; {hint}')


def load_configuration(name: str) -> Configuration:
    """Read and check a configuration; an unknown parameter is refused with the nearest known one."""
    from wsn_tracking.ros_yaml import parse

    path = find_configuration(name)
    try:
        text = path.read_text('utf-8')
    except (OSError, UnicodeDecodeError) as error:
        raise TrackingError(f'{path} cannot be read as text: {error}') from error
    content = parse(text, str(path))
    if not isinstance(content, dict):
        raise TrackingError(f'{path} holds no sections: expected `/**:` with `ros__parameters:` below it')
    sections = {}
    for section, body in content.items():
        if not isinstance(body, dict) or not isinstance(body.get('ros__parameters'), dict):
            raise TrackingError(f'{path}: section `{section}` has no `ros__parameters:` with names below it')
        sections[str(section)] = dict(_flat(body['ros__parameters']))
        for parameter in sections[str(section)]:
            _check_known(parameter, str(path))
    return Configuration(sections)


def parse_setting(text: str) -> tuple[str, Any]:
    """name=value of the command line; the value is YAML."""
    name, separator, value = text.partition('=')
    if not separator:
        raise TrackingError(f'setting {text!r}: expected name=value, e.g. trigger.kind=near')
    _check_known(name, f'setting {text!r}')
    from wsn_tracking.ros_yaml import parse  # no node needs it: ROS reads parameter files for them

    return name, parse(value, f'setting {text!r}')


def _flat(values: Mapping[str, Any], prefix: str = '') -> Iterator[tuple[str, Any]]:
    for key, value in values.items():
        if isinstance(value, dict):
            yield from _flat(value, f'{prefix}{key}.')
        else:
            yield f'{prefix}{key}', value


@cache
def _known() -> frozenset[str]:
    return frozenset(spec.name for kind in (*EXECUTABLES.values(), NodeConfig) for spec in specs(kind))


def _check_known(name: str, where: str) -> None:
    known = _known()
    if name in known or name == 'use_sim_time' or name.startswith('qos_overrides.'):
        return
    near = difflib.get_close_matches(name, sorted(known), 1)
    hint = f'did you mean `{near[0]}`?' if near else 'docs/parameters.md lists all'
    raise TrackingError(f'{where}: there is no parameter `{name}`; {hint}')

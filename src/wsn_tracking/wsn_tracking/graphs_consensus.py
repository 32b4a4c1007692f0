"""The graph of system B: its nodes in a few processes, each with the nodes of one district of the field."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from wsn_tracking.configuration import Configuration, Values, load_configuration
from wsn_tracking.errors import TrackingError
from wsn_tracking.graph_parts import LOSS_TIMEOUT, Process, Source, Tracked, complete, numbers_of
from wsn_tracking.models.anchors import Anchors
from wsn_tracking.models.graph import adjacency
from wsn_tracking.node_parameters.consensus import ConsensusNodeConfig
from wsn_tracking.parameters import build

CONSENSUS = 'consensus'  # system and configuration
NODES = ('consensus_node', 'evaluator', 'bag_player', 'bag_recorder', 'world', 'marker')
PROCESSES = 4


class ConsensusPlan(NamedTuple):
    """System B on one feed: the parameters of all nodes, and which of them live together."""

    values: Values
    districts: tuple[tuple[int, ...], ...]
    neighbours: Mapping[int, tuple[int, ...]]  # of every node

    @property
    def target_id(self) -> int:
        """The target that is tracked."""
        return int(self.values['target_id'])

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the estimates."""
        return tuple(f'consensus_{i}' for i in sorted(i for district in self.districts for i in district))


def is_consensus(source: Source, trackers: str = '', configuration: str = '') -> bool:
    """Whether a feed is for system B: when asked for, or by the configuration, or since only that takes bearings."""
    if trackers not in {'', 'all'}:
        return trackers == CONSENSUS
    named = configuration or source.metadata.get('configuration', '')
    return source.entry_level == 'observation' or Path(named).stem == CONSENSUS


def plan_consensus(
    source: Source,
    anchors: Anchors,
    configuration: Configuration | str = '',
    settings: Values | None = None,
    target_id: int = -1,
    processes: int = PROCESSES,
) -> ConsensusPlan:
    """Parameters of the nodes: the feed's own first, then the configuration's, then `settings`; all checked."""
    if isinstance(configuration, str):
        named = source.metadata.get('configuration', '') if source.entry_level == 'observation' else ''
        configuration = load_configuration(configuration or named or CONSENSUS)
    configuration.check_sections(NODES)
    values: dict[str, Any] = {
        'target_id': source.targets[0] if source.targets else -1,
        **numbers_of(source, target_height=('target_height', 1.0), period=('period', 1.0)),
        **configuration.of('consensus_node'),
        **(settings or {}),
        **({'target_id': target_id} if target_id >= 0 else {}),
        'input': source.entry_level,
    }
    radius = build(ConsensusNodeConfig, values).checked().radius
    if source.targets and values['target_id'] not in source.targets:
        raise TrackingError(
            f'{source.title} has no target {values["target_id"]}: expected one of {list(source.targets)}'
        )
    near = {
        i: tuple(anchors.ids[row].tolist())
        for i, row in zip(anchors.ids.tolist(), adjacency(anchors.positions, radius), strict=True)
    }
    return ConsensusPlan(values, districts(anchors, processes), near)


def districts(anchors: Anchors, count: int) -> tuple[tuple[int, ...], ...]:
    """The ids in at most `count` groups of neighbours, halved across the longer side: few shares leave a group."""
    if count < 2 or anchors.ids.size < 2:
        return (tuple(sorted(anchors.ids.tolist())),)
    plane = anchors.positions[:, :2]
    order = np.argsort(plane[:, int(np.argmax(np.ptp(plane, axis=0)))], kind='stable')
    here = count // 2
    middle = max(round(order.size * here / count), 1)
    parts = ((order[:middle], here), (order[middle:], count - here))
    return tuple(group for rows, n in parts for group in districts(anchors.select(anchors.ids[rows]), n))


def consensus_graph(
    source: Source,
    plan: ConsensusPlan,
    feed: Process,
    *,
    replay: bool = False,
    settings: Values | None = None,
    evaluator: Values | None = None,
    record: Values | None = None,
    one_process_each: bool = False,
    markers: bool = False,
) -> tuple[Process, ...]:
    """Feed, nodes (a process for each district, or for each node), evaluator; a recorder and markers where asked for.

    In replay, what is missing from the input is an error, and rounds wait as long as a share may take to come; live
    and in simulation, they end in time for the next epoch.
    """
    config = build(ConsensusNodeConfig, plan.values)
    patient = {'lossless': False, 'loss_timeout': 0.5 * config.period}
    if replay:
        patient = {'lossless': True, 'loss_timeout': LOSS_TIMEOUT}
        patient['round_timeout'] = LOSS_TIMEOUT / max(config.rounds, 1)
    values = {**plan.values, **{name: (settings or {}).get(name, value) for name, value in patient.items()}}
    groups = plan.districts
    if one_process_each:
        groups = tuple((i,) for district in groups for i in district)
    processes = [_process(ids, number, values, plan.neighbours) for number, ids in enumerate(groups, 1)]
    window = tuple(f'consensus_{ids[-1]}' for ids in groups)
    tracked = Tracked(plan.target_id, plan.outputs, window, plan.values)
    return complete(source, tracked, processes, feed, evaluator=evaluator, record=record, markers=markers)


def _process(ids: Sequence[int], number: int, values: Values, neighbours: Mapping[int, tuple[int, ...]]) -> Process:
    foreign = sorted({j for i in ids for j in neighbours[i]} - set(ids))
    reports = ('trigger_report',) if values['input'] == 'range' else ()
    return Process(
        'consensus_node',
        f'consensus_nodes_{number}',
        {**values, 'ids': list(ids)},
        takes=(
            'request',
            'epoch_end',
            'anchors',
            str(values['input']),
            *reports,
            *(f'consensus/node_{j}' for j in foreign),
        ),
        gives=tuple(
            topic
            for i in ids
            for topic in (f'consensus/node_{i}', *(f'{k}/consensus_{i}' for k in ('estimate', 'odometry')))
        ),
    )

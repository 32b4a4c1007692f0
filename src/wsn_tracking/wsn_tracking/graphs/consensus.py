"""The graph of system B: its nodes in a few processes, each with the nodes of one district of the field."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from wsn_tracking.configuration import Configuration
from wsn_tracking.graphs.parts import LISTENERS, LOSS_TIMEOUT, How, Process, Source, numbers_of, reported
from wsn_tracking.models.anchors import Anchors
from wsn_tracking.models.graph import adjacency
from wsn_tracking.node_parameters.consensus import ConsensusNodeConfig
from wsn_tracking.parameters import Values, build

CONSENSUS = 'consensus'  # system and configuration
NODES = (*LISTENERS, 'consensus_node')
PROCESSES = 4


class ConsensusPlan(NamedTuple):
    """System B on one feed: the parameters of all nodes, and which of them live together."""

    values: Values
    districts: tuple[tuple[int, ...], ...]
    neighbours: Mapping[int, tuple[int, ...]]  # of every node

    @property
    def system(self) -> str:
        """Its name."""
        return CONSENSUS

    @property
    def target_id(self) -> int:
        """The target that is tracked."""
        return int(self.values['target_id'])

    @property
    def outputs(self) -> Mapping[str, int]:
        """Names of the estimates, each with its target."""
        ids = sorted(i for district in self.districts for i in district)
        return dict.fromkeys((f'consensus_{i}' for i in ids), self.target_id)

    def window(self, how: How) -> tuple[str, ...]:
        """The outputs that the feed stays close to: of one node a process."""
        return tuple(f'consensus_{ids[-1]}' for ids in self._groups(how))

    def _groups(self, how: How) -> tuple[tuple[int, ...], ...]:
        return tuple((i,) for ids in self.districts for i in ids) if how.one_process_each else self.districts

    @property
    def parameters(self) -> Values:
        """What its configuration gives to those who listen as well."""
        return self.values

    @property
    def inputs(self) -> tuple[str, ...]:
        """What the evaluator takes besides estimates."""
        return ()

    @property
    def drawn(self) -> Collection[str]:
        """The outputs that markers show: of one node, since they agree."""
        return tuple(self.outputs)[:1]

    def processes(self, source: Source, how: How) -> list[Process]:
        """A process for each district, or for each node.

        In replay, rounds wait as long as a share may take to come; live and in simulation, they end in time for the
        next epoch.
        """
        config = build(ConsensusNodeConfig, self.values)
        timing = how.timing(lossless=False, loss_timeout=0.5 * config.period)
        if how.replay:
            patience = LOSS_TIMEOUT / max(config.rounds, 1)
            timing = how.timing(lossless=True, loss_timeout=LOSS_TIMEOUT, round_timeout=patience)
        values = {**self.values, **timing}
        return [_process(ids, k, values, self.neighbours) for k, ids in enumerate(self._groups(how), 1)]


def plan_consensus(
    source: Source,
    anchors: Anchors,
    configuration: Configuration,
    settings: Values | None = None,
    target_id: int = -1,
    processes: int = PROCESSES,
) -> ConsensusPlan:
    """Parameters of the nodes: the feed's own first, then the configuration's, then `settings`; all checked."""
    configuration.check_sections(NODES)
    values: dict[str, Any] = {
        'target_id': source.target(-1),
        **numbers_of(source, target_height=('target_height', 1.0), period=('period', 1.0)),
        **configuration.of('consensus_node'),
        **(settings or {}),
        **({'target_id': target_id} if target_id >= 0 else {}),
        'input': source.entry_level,
    }
    values['target_id'] = source.target(values['target_id'])
    radius = build(ConsensusNodeConfig, values).checked().radius
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


def _process(ids: Sequence[int], number: int, values: Values, neighbours: Mapping[int, tuple[int, ...]]) -> Process:
    foreign = sorted({j for i in ids for j in neighbours[i]} - set(ids))
    return Process(
        'consensus_node',
        f'consensus_nodes_{number}',
        {**values, 'ids': list(ids)},
        takes=(
            'request',
            'epoch_end',
            'anchors',
            str(values['input']),
            *reported(str(values['input'])),
            *(f'consensus/node_{j}' for j in foreign),
        ),
        gives=tuple(
            topic
            for i in ids
            for topic in (f'consensus/node_{i}', *(f'{k}/consensus_{i}' for k in ('estimate', 'odometry')))
        ),
    )

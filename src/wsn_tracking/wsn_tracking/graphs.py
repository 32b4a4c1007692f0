"""One table a graph: its processes, their parameters, what they take and give.

The launch files and the command line start what these functions return; the evaluator runs the same plan
without any process. Nothing here knows ROS beyond names.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from wsn_tracking.configuration import Configuration, Values, load_configuration
from wsn_tracking.errors import TrackingError
from wsn_tracking.graph_parts import (
    LOSS_TIMEOUT,
    Process,
    Source,
    Tracked,
    complete,
    not_a_number,
    open_bag,
    source_of,
)
from wsn_tracking.graphs_consensus import ConsensusPlan, consensus_graph, is_consensus, plan_consensus
from wsn_tracking.node_parameters.estimator import EstimatorNodeConfig
from wsn_tracking.node_parameters.sensing import SensingNodeConfig
from wsn_tracking.node_parameters.serial import SerialBridgeConfig
from wsn_tracking.parameters import build
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.simulation.record import record as record_scenario
from wsn_tracking.simulation.scenarios import scenario

__all__ = [
    'ConsensusPlan',
    'Plan',
    'Process',
    'Source',
    'open_bag',
    'plan_of',
    'plan_random_q',
    'random_q_graph',
    'replay',
    'serial',
    'simulation',
    'source_of',
]

DEFAULT = 'random_q'  # configuration
BRIDGE = 'serial_bridge'
NODES = (BRIDGE, 'sensing', 'sensing_node', 'estimator', 'evaluator', 'bag_player', 'bag_recorder', 'world', 'marker')
FUSION_TIMEOUT = 2.0  # [s] a peer that has died; never reached by one that lives


class Plan(NamedTuple):
    """System A on one feed: the parameters of its sensing stage (none where ranges come as such) and estimators."""

    sensing: Values | None
    estimators: tuple[Values, ...]

    @property
    def target_id(self) -> int:
        """The target that is tracked."""
        return int(self.estimators[0]['target_id'])

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the estimates, locals first."""
        ids = [values['id'] for values in self.estimators]
        return (*(f'local_{i}' for i in ids), *(f'fused_{i}' for i in ids))


def plan_random_q(
    source: Source, configuration: Configuration | str = '', settings: Values | None = None, target_id: int = -1
) -> Plan:
    """Parameters of every node: the feed's own first, then the configuration's, then `settings`; all checked.

    A configuration by name or path; empty: the one that the feed names, else random_q.
    """
    if isinstance(configuration, str):
        configuration = load_configuration(configuration or source.metadata.get('configuration') or DEFAULT)
    # the first target by name: what a node hears first depends on the order of arrival
    base = {**_from_metadata(source), 'target_id': source.targets[0] if source.targets else -1}
    given = {**(settings or {}), **({'target_id': target_id} if target_id >= 0 else {})}

    def values(node: str, **fixed: Any) -> dict[str, Any]:
        return {**base, **configuration.of(node), **given, **fixed}

    peers = sorted(build(EstimatorNodeConfig, values('estimator')).peers)
    if not peers:
        raise TrackingError('`peers` is empty: expected the number of at least one estimator')
    configuration.check_sections([*NODES, *(f'estimator_{n}' for n in peers), *(f'sensing_{i}' for i in source.ids)])
    estimators = []
    for number in peers:
        chosen = values(f'estimator_{number}', id=number, peers=list(peers))
        chosen['input'] = _input(source.entry_level, build(EstimatorNodeConfig, chosen).checked().input)
        estimators.append(chosen)
        if source.targets and chosen['target_id'] not in source.targets:
            raise TrackingError(
                f'{source.title} has no target {chosen["target_id"]}: expected one of {list(source.targets)}'
            )
    inputs = {chosen['input'] for chosen in estimators}
    if source.entry_level == 'rssi' and 'range' in inputs:
        sensing = values('sensing_node')
        build(SensingNodeConfig, sensing).trigger.strategy()
        return Plan(sensing, tuple(estimators))
    return Plan(None, tuple(estimators))


def _input(entry_level: str, wanted: str) -> str:
    if entry_level == 'observation':
        raise TrackingError('system random_q takes rssi or range, the bag holds observation')
    if wanted == 'rssi' and entry_level == 'range':
        raise TrackingError('`input` is rssi, but the bag enters at level range: set `input` to range or auto')
    return 'range' if wanted == 'auto' else wanted


def _from_metadata(source: Source) -> dict[str, Any]:
    """Parameters that a bag knows of itself."""
    values: dict[str, Any] = {}
    try:
        if source.area:
            values['area'] = list(source.area)
        if 'target_height' in source.metadata:
            values['target_height'] = float(source.metadata['target_height'])
        if 'period' in source.metadata:
            values['fusion_timeout'] = 0.2 * float(source.metadata['period'])
    except ValueError as error:
        raise not_a_number(source, error) from error
    return values


def plan_of(
    source: Source,
    recording: Recording,
    trackers: str = '',
    configuration: str = '',
    settings: Values | None = None,
    target_id: int = -1,
) -> Plan | ConsensusPlan:
    """The plan of the system in `trackers`: random_q or consensus; by default the one that the feed is of."""
    if is_consensus(source, trackers, configuration):
        return plan_consensus(source, recording.anchors, configuration, settings, target_id)
    return plan_random_q(source, configuration, settings, target_id)


# ---- the graph over it


def replay(
    bag: str,
    *,
    rate: float = 1.0,
    trackers: str = '',
    configuration: str = '',
    settings: Values | None = None,
    target_id: int = -1,
    namespace: str | None = None,
    evaluator: Values | None = None,
    record: Values | None = None,
    one_process_each: bool = False,
    markers: bool = False,
    progress: bool = False,
) -> tuple[Process, ...]:
    """A bag through the live graph of a system; rate 0 is as fast as it goes."""
    source, recording = open_bag(bag, namespace)
    plan = plan_of(source, recording, trackers, configuration, settings, target_id)
    source = source.of_target(plan.target_id)
    feed = Process(
        'bag_player_node',
        'bag_player',
        {
            'bag': str(Path(bag).resolve()),
            'rate': rate,
            'namespace': namespace or '',
            'progress': progress,
            'target_id': plan.target_id,
        },
    )
    return _graph(
        source,
        plan,
        feed,
        replay=True,
        settings=settings,
        evaluator=evaluator or {},
        record=record,
        one_process_each=one_process_each,
        markers=markers,
    )


def simulation(
    name: str,
    seed: int = 0,
    *,
    rate: float = 1.0,
    start_stamp: float = 0.0,
    trackers: str = '',
    configuration: str = '',
    settings: Values | None = None,
    evaluator: Values | None = None,
    record: str = '',
    one_process_each: bool = False,
    markers: bool = False,
) -> tuple[Process, ...]:
    """A simulated world and the live graph of a system; the world sends as slowly as the graph needs."""
    recording = record_scenario(scenario(name, seed=seed), seed)
    source = source_of(name, recording)
    plan = plan_of(source, recording, trackers, configuration, settings)
    feed = Process('world_node', 'world', {'scenario': name, 'seed': seed, 'rate': rate, 'start_stamp': start_stamp})
    return _graph(
        source,
        plan,
        feed,
        replay=False,
        settings=settings,
        evaluator=evaluator or {},
        record={'output': str(Path(record).resolve())} if record else None,
        one_process_each=one_process_each,
        markers=markers,
    )


def _graph(source: Source, plan: Plan | ConsensusPlan, feed: Process, **options: Any) -> tuple[Process, ...]:
    if isinstance(plan, ConsensusPlan):
        return consensus_graph(source, plan, feed, **options)
    return random_q_graph(source, plan, feed, **options)


def serial(
    configuration: str = 'serial_bridge',
    *,
    settings: Values | None = None,
    evaluator: Values | None = None,
    record: str = '',
    markers: bool = False,
) -> tuple[Process, ...]:
    """A sink on a serial line and the live graph of system A; an evaluator only where somebody publishes the truth."""
    loaded = load_configuration(configuration)
    given = {**loaded.of(BRIDGE), **(settings or {})}
    bridge = build(SerialBridgeConfig, given)
    source = Source(
        title='serial',
        entry_level='rssi',
        ids=bridge.anchors.ids,
        targets=(),
        metadata={'period': f'{bridge.period:g}'},
        topics=('request', 'rssi', 'epoch_end'),
    )
    plan = plan_random_q(source, loaded, settings)
    return random_q_graph(
        source,
        plan,
        Process('serial_bridge_node', BRIDGE, given),
        live=True,
        settings=settings,
        evaluator=evaluator,
        record={'output': str(Path(record).resolve())} if record else None,
        markers=markers,
    )


def random_q_graph(
    source: Source,
    plan: Plan,
    feed: Process,
    *,
    replay: bool = False,
    live: bool = False,
    settings: Values | None = None,
    evaluator: Values | None = None,
    record: Values | None = None,
    one_process_each: bool = False,
    markers: bool = False,
) -> tuple[Process, ...]:
    """Feed, sensing nodes (in one process, or one each), estimators, evaluator; a recorder and markers where asked for.

    Player and world wait for the graph, so no timeout of a live network applies, unless `settings` say so; in replay,
    what is missing is an error. A `live` feed waits for nobody. Parameters of feed, evaluator and recorder come from
    the plan as well.
    """
    patient = {'lossless': replay, 'loss_timeout': LOSS_TIMEOUT, 'fusion_timeout': FUSION_TIMEOUT}
    if live:
        patient = {'lossless': False}
    timing = {name: (settings or {}).get(name, value) for name, value in patient.items()}
    processes = [_sensing(node, plan, timing) for node in _split(source, plan, one_process_each)]
    numbers = [values['id'] for values in plan.estimators]
    processes += [_estimator(values, numbers, timing) for values in plan.estimators]
    names = [f'fused_{number}' for number in numbers]
    tracked = Tracked(plan.target_id, plan.outputs, tuple(names), plan.estimators[0], ('trigger_report',))
    return complete(source, tracked, processes, feed, evaluator=evaluator, record=record, markers=markers)


def _split(source: Source, plan: Plan, one_process_each: bool) -> list[tuple[int, ...]]:
    """Node ids of each sensing process."""
    if plan.sensing is None:
        return []
    return [(node,) for node in source.ids] if one_process_each else [source.ids]


def _sensing(ids: tuple[int, ...], plan: Plan, timing: Values) -> Process:
    name = f'sensing_{ids[0]}' if len(ids) == 1 else 'sensing'
    return Process(
        'sensing_node',
        name,
        {**(plan.sensing or {}), **timing, 'ids': list(ids)},
        takes=('request', 'rssi', 'epoch_end', 'anchors'),
        gives=('range', 'trigger_report'),
    )


def _estimator(values: Values, numbers: Sequence[int], timing: Values) -> Process:
    number, measured = values['id'], values['input']
    reports = ('trigger_report',) if measured == 'range' else ()
    return Process(
        'estimator_node',
        f'estimator_{number}',
        {**values, **timing},
        takes=(
            'request',
            'epoch_end',
            'anchors',
            measured,
            *reports,
            *(f'estimate/local_{other}' for other in numbers if other != number),
        ),
        gives=tuple(f'{kind}/{output}_{number}' for kind in ('estimate', 'odometry') for output in ('local', 'fused')),
    )

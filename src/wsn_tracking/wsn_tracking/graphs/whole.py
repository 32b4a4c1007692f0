"""Graphs as they are started: a feed, the systems that track on it, and who listens."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from wsn_tracking.configuration import load_configuration
from wsn_tracking.errors import TrackingError
from wsn_tracking.graphs.parts import How, Plan, Process, Source, complete, open_bag, source_of, targets_of
from wsn_tracking.graphs.plans import plans_of, systems_of
from wsn_tracking.graphs.random_q import BRIDGE, RANDOM_Q, plan_random_q
from wsn_tracking.node_parameters.common import AssemblyConfig
from wsn_tracking.node_parameters.executables import EXECUTABLES
from wsn_tracking.node_parameters.serial import SerialBridgeConfig
from wsn_tracking.parameters import Values, build
from wsn_tracking.simulation.record import record as record_scenario
from wsn_tracking.simulation.scenarios import scenario, settings_of

LEVELS = ('rssi', 'range')  # what motes report


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
    """A bag through the live graph of its systems; rate 0 is as fast as it goes."""
    source, recording = open_bag(bag, namespace)
    plans = plans_of(source, recording.anchors, trackers, configuration, settings, target_id)
    targets = targets_of(plans)
    if len(targets) == 1:
        source = source.of_target(*targets)
    feed = Process(
        'bag_player_node',
        'bag_player',
        {
            'bag': str(Path(bag).resolve()),
            'rate': rate,
            'namespace': namespace or '',
            'progress': progress,
            'target_id': targets[0] if len(targets) == 1 else -1,
        },
    )
    return complete(
        source,
        plans,
        feed,
        How(replay=True, settings=settings or {}, one_process_each=one_process_each),
        evaluator=evaluator or {},
        record=record,
        markers=markers,
    )


def simulation(
    name: str,
    seed: int = 0,
    *,
    scenario_settings: Sequence[str] = (),
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
    """A simulated world and the live graph of its systems; the world sends as slowly as the graph needs.

    scenario_settings: name=value each, of the scenario; `settings` are parameters of the nodes.
    """
    recording = record_scenario(scenario(name, settings_of(scenario_settings), seed), seed)
    source = source_of(name, recording)
    world = {'scenario': name, 'seed': seed, 'settings': list(scenario_settings) or ['']}
    return complete(
        source,
        plans_of(source, recording.anchors, trackers, configuration, settings),
        Process('world_node', 'world', {**world, 'rate': rate, 'start_stamp': start_stamp}),
        How(settings=settings or {}, one_process_each=one_process_each),
        evaluator=evaluator or {},
        record={'output': str(Path(record).resolve())} if record else None,
        markers=markers,
    )


def serial(
    configuration: str = BRIDGE,
    *,
    trackers: str = '',
    level: str = 'rssi',
    settings: Values | None = None,
    evaluator: Values | None = None,
    record: str = '',
    markers: bool = False,
) -> tuple[Process, ...]:
    """A sink on a serial line and the live graph of the systems; an evaluator only where somebody publishes the truth.

    level: what the motes report, rssi or range. Without `trackers`, it is system A.
    """
    loaded = load_configuration(configuration)
    given = {**loaded.of(BRIDGE), **(settings or {})}
    bridge = build(SerialBridgeConfig, given)
    if level not in LEVELS:
        raise TrackingError(f'level {level!r}: motes report {" or ".join(LEVELS)}')
    source = Source(
        title='serial',
        entry_level=level,
        ids=bridge.anchors.ids,
        targets=(),
        metadata={'period': f'{bridge.period:g}'},
        topics=('request', level, 'epoch_end'),
    )
    graph = complete(
        source,
        _behind(source, bridge, trackers, configuration, settings),
        Process('serial_bridge_node', BRIDGE, given),
        How(live=True, settings=settings or {}),
        evaluator=evaluator,
        record={'output': str(Path(record).resolve())} if record else None,
        markers=markers,
    )
    for process in graph:
        takes_epochs = issubclass(EXECUTABLES[process.executable], AssemblyConfig)
        if takes_epochs and bridge.ends_after >= (patience := build(AssemblyConfig, process.parameters).loss_timeout):
            raise TrackingError(
                f'the bridge ends an epoch after {bridge.ends_after:g} s, but `loss_timeout` of {process.name} is '
                f'{patience:g} s: set it above `epoch_timeout` (0.4 `period`), or epochs are given up before they end'
            )
    return graph


def _behind(
    source: Source, bridge: SerialBridgeConfig, trackers: str, configuration: str, settings: Values | None
) -> tuple[Plan, ...]:
    """The plans of the systems behind a bridge: system A by the bridge's configuration, others by theirs.

    A configuration that was made for this field, any but the bridge's own, is for all of them.
    """
    loaded = load_configuration(configuration)
    plans: list[Plan] = []
    for system in systems_of(source, trackers or RANDOM_Q):
        if system == RANDOM_Q:
            plans.append(plan_random_q(source, loaded, settings))
        elif not bridge.anchors.ids:
            raise TrackingError(f'`anchors.ids` of the bridge is empty: {system} has to know the places of the nodes')
        else:
            made_for_it = '' if configuration == BRIDGE else loaded.but(BRIDGE)
            plans += plans_of(source, bridge.anchors.table, system, made_for_it, settings)
    return tuple(plans)

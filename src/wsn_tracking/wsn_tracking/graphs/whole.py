"""Graphs as they are started: a feed, the systems that track on it, and who listens."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from wsn_tracking.configuration import load_configuration
from wsn_tracking.errors import TrackingError
from wsn_tracking.graphs.parts import How, Process, Source, complete, open_bag, source_of, targets_of
from wsn_tracking.graphs.plans import plans_of
from wsn_tracking.graphs.random_q import BRIDGE, plan_random_q
from wsn_tracking.node_parameters.common import AssemblyConfig
from wsn_tracking.node_parameters.serial import SerialBridgeConfig
from wsn_tracking.parameters import Values, build
from wsn_tracking.simulation.record import record as record_scenario
from wsn_tracking.simulation.scenarios import scenario, settings_of


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
    for values in (plan.sensing, *plan.estimators):
        if values is not None and bridge.ends_after >= (patience := build(AssemblyConfig, values).loss_timeout):
            raise TrackingError(
                f'the bridge ends an epoch after {bridge.ends_after:g} s, but `loss_timeout` is {patience:g} s: '
                'set it above `epoch_timeout` (0.4 `period`), or epochs are given up before they end'
            )
    return complete(
        source,
        [plan],
        Process('serial_bridge_node', BRIDGE, given),
        How(live=True, settings=settings or {}),
        evaluator=evaluator,
        record={'output': str(Path(record).resolve())} if record else None,
        markers=markers,
    )

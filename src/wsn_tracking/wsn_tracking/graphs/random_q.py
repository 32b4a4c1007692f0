"""The graph of system A: sensing nodes in one process or one each, and the estimators."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any, NamedTuple

from wsn_tracking.configuration import Configuration
from wsn_tracking.errors import TrackingError
from wsn_tracking.graphs.parts import LISTENERS, LOSS_TIMEOUT, How, Process, Source, not_a_number, reported
from wsn_tracking.node_parameters.estimator import EstimatorNodeConfig
from wsn_tracking.node_parameters.sensing import SensingNodeConfig
from wsn_tracking.parameters import Values, build

RANDOM_Q = 'random_q'  # system and configuration
BRIDGE = 'serial_bridge'
NODES = (*LISTENERS, BRIDGE, 'sensing', 'sensing_node', 'estimator')
FUSION_TIMEOUT = 2.0  # [s] a peer that has died; never reached by one that lives


class RandomQPlan(NamedTuple):
    """System A on one feed: the parameters of its sensing stage (none where ranges come as such) and estimators."""

    sensing: Values | None
    estimators: tuple[Values, ...]

    @property
    def system(self) -> str:
        """Its name."""
        return RANDOM_Q

    @property
    def target_id(self) -> int:
        """The target that is tracked."""
        return int(self.estimators[0]['target_id'])

    @property
    def outputs(self) -> Mapping[str, int]:
        """Names of the estimates, locals first, each with its target."""
        names = [f'{kind}_{values["id"]}' for kind in ('local', 'fused') for values in self.estimators]
        return dict.fromkeys(names, self.target_id)

    def window(self, how: How) -> tuple[str, ...]:
        """The outputs that the feed stays close to."""
        return tuple(f'fused_{values["id"]}' for values in self.estimators)

    @property
    def parameters(self) -> Values:
        """What its configuration gives to those who listen as well."""
        return self.estimators[0]

    @property
    def inputs(self) -> tuple[str, ...]:
        """What the evaluator takes besides estimates."""
        return ('trigger_report',)

    @property
    def drawn(self) -> Collection[str]:
        """The outputs that markers show."""
        return self.outputs

    def processes(self, source: Source, how: How) -> list[Process]:
        """Sensing nodes, in one process or one each, and estimators."""
        timing = how.timing(lossless=how.replay)
        if not how.live:
            timing = how.timing(lossless=how.replay, loss_timeout=LOSS_TIMEOUT, fusion_timeout=FUSION_TIMEOUT)
        numbers = [values['id'] for values in self.estimators]
        sensing = _split(source.ids, how.one_process_each) if self.sensing is not None else []
        return [
            *(_sensing(ids, {**(self.sensing or {}), **timing}) for ids in sensing),
            *(_estimator({**values, **timing}, numbers) for values in self.estimators),
        ]


def plan_random_q(
    source: Source, configuration: Configuration, settings: Values | None = None, target_id: int = -1
) -> RandomQPlan:
    """Parameters of every node: the feed's own first, then the configuration's, then `settings`; all checked."""
    base = {**_from_metadata(source), 'target_id': source.target(-1)}
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
        chosen['target_id'] = source.target(chosen['target_id'])
        estimators.append(chosen)
    inputs = {chosen['input'] for chosen in estimators}
    if source.entry_level == 'rssi' and 'range' in inputs:
        sensing = values('sensing_node')
        build(SensingNodeConfig, sensing).trigger.strategy()
        return RandomQPlan(sensing, tuple(estimators))
    return RandomQPlan(None, tuple(estimators))


def _input(entry_level: str, wanted: str) -> str:
    """What the estimators take: ranges, unless they are to take what they are made of."""
    if wanted == 'auto':
        return 'observation' if entry_level == 'observation' else 'range'
    if entry_level not in {wanted, 'rssi'} or (entry_level == 'rssi' and wanted == 'observation'):
        raise TrackingError(
            f'`input` is {wanted}, but the bag enters at level {entry_level}: set `input` to {entry_level} or auto'
        )
    return wanted


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
            values['loss_timeout'] = max(1.0, float(source.metadata['period']))
    except ValueError as error:
        raise not_a_number(source, error) from error
    return values


def _split(ids: Sequence[int], one_process_each: bool) -> list[tuple[int, ...]]:
    """Node ids of each sensing process."""
    return [(node,) for node in ids] if one_process_each else [tuple(ids)]


def _sensing(ids: tuple[int, ...], values: Values) -> Process:
    return Process(
        'sensing_node',
        f'sensing_{ids[0]}' if len(ids) == 1 else 'sensing',
        {**values, 'ids': list(ids)},
        takes=('request', 'rssi', 'epoch_end', 'anchors'),
        gives=('range', 'trigger_report'),
    )


def _estimator(values: Values, numbers: Sequence[int]) -> Process:
    number, measured = values['id'], values['input']
    return Process(
        'estimator_node',
        f'estimator_{number}',
        values,
        takes=(
            'request',
            'epoch_end',
            'anchors',
            measured,
            *reported(measured),
            *(f'estimate/local_{other}' for other in numbers if other != number),
        ),
        gives=tuple(f'{kind}/{output}_{number}' for kind in ('estimate', 'odometry') for output in ('local', 'fused')),
    )

"""Graphs of the systems that are one node: the human, the hybrid and the loss-tolerant tracker."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any, NamedTuple

from wsn_tracking.configuration import Configuration
from wsn_tracking.graphs.parts import LISTENERS, LOSS_TIMEOUT, How, Process, Source, numbers_of, reported
from wsn_tracking.node_parameters.human import HumanNodeConfig
from wsn_tracking.node_parameters.hybrid import HybridNodeConfig
from wsn_tracking.node_parameters.loss_tolerant import LossTolerantNodeConfig
from wsn_tracking.node_parameters.trackers import TrackerNodeConfig
from wsn_tracking.parameters import Values, build

CONFIGS: Mapping[str, type[TrackerNodeConfig]] = {
    'human': HumanNodeConfig,
    'hybrid': HybridNodeConfig,
    'loss_tolerant': LossTolerantNodeConfig,
}


class SinglePlan(NamedTuple):
    """One such system on one feed."""

    system: str
    values: Values
    targets: tuple[int, ...]

    @property
    def config(self) -> TrackerNodeConfig:
        """The parameters of its node."""
        return checked_config(self.system, self.values)

    @property
    def outputs(self) -> Mapping[str, int]:
        """Names of the estimates, each with its target."""
        config = self.config
        return {name: target for target in self.targets for name in config.outputs(target)}

    def window(self, how: How) -> tuple[str, ...]:
        """The outputs that the feed stays close to: the first of each target."""
        config = self.config
        return tuple(config.outputs(target)[0] for target in self.targets)

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
        """The outputs that markers show."""
        return self.outputs

    def processes(self, source: Source, how: How) -> list[Process]:
        """The node."""
        timing = how.timing(lossless=how.replay)
        if not how.live:
            timing = how.timing(lossless=how.replay, loss_timeout=LOSS_TIMEOUT)
        measured = str(self.values['input'])
        return [
            Process(
                f'{self.system}_tracker_node',
                f'{self.system}_tracker',
                {**self.values, **timing},
                takes=('request', 'epoch_end', 'anchors', measured, *reported(measured)),
                gives=tuple(f'{kind}/{name}' for kind in ('estimate', 'odometry') for name in self.outputs),
            )
        ]


def checked_config(system: str, values: Values) -> TrackerNodeConfig:
    """The parameters of a node; TrackingError where they are wrong."""
    config: TrackerNodeConfig = build(CONFIGS[system], values)
    return config.checked()


def plan_single(
    system: str, source: Source, configuration: Configuration, settings: Values | None = None, target_id: int = -1
) -> SinglePlan:
    """Parameters of the node: the feed's own first, then the configuration's, then `settings`; all checked."""
    node = f'{system}_tracker'
    configuration.check_sections([*LISTENERS, node, f'{node}_node'])
    area = {'area': list(source.area)} if source.area else {}
    values: dict[str, Any] = {
        **area,
        **numbers_of(source, target_height=('target_height', 1.0), period=('period', 1.0)),
        **_patience(source),
        **configuration.of(node),
        **configuration.of(f'{node}_node'),
        **(settings or {}),
        **({'target_id': target_id} if target_id >= 0 else {}),
        'input': source.entry_level,
    }
    config = checked_config(system, values)
    config.check_files()
    one = source.target(config.target_id)
    targets = tuple(sorted(source.targets)) if config.several and config.target_id < 0 else (one,)
    if not config.several:
        values['target_id'] = one
    return SinglePlan(system, {**values, 'targets': list(targets)} if config.several else values, targets)


def _patience(source: Source) -> dict[str, float]:
    """No message counts as lost before its epoch can have ended."""
    periods = numbers_of(source, loss_timeout=('period', 1.0))
    return {name: max(1.0, period) for name, period in periods.items()}

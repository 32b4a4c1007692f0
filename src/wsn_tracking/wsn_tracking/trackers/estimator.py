"""One estimator of system A as a node or the evaluator runs it: whom it hears, what it filters, what it fuses."""

from __future__ import annotations

from dataclasses import dataclass

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import Anchors
from wsn_tracking.parameters import group, param
from wsn_tracking.sensing.channel_file import calibrated
from wsn_tracking.trackers.fusing import Fuser, FusionConfig
from wsn_tracking.trackers.random_q import LocalEstimator
from wsn_tracking.trackers.random_q_config import RandomQConfig


@dataclass(frozen=True)
class EstimatorConfig(RandomQConfig):
    """One estimator: its number, its peers, the nodes that it hears, and its filter and fusion."""

    id: int = param(1, 'number of this estimator', 'id', 0, 65535)
    peers: tuple[int, ...] = param((1, 2, 3), 'numbers of all estimators; one alone fuses only its own', 'id', 0, 65535)
    nodes: tuple[int, ...] = param((), 'sensing nodes that it hears; empty: all', 'id', 0, 65535)
    input: str = param(
        'auto',
        'topic that measurements come from; auto: range, rssi or observation, the first that somebody publishes',
        choices=('auto', 'range', 'rssi', 'observation'),
    )
    channel: str = param(
        '', 'file of `calibrate` with the radios of the nodes and, for `input` rssi, their map; empty: the anchors tell'
    )
    fusion: FusionConfig = group(FusionConfig)

    def checked(self) -> EstimatorConfig:
        """Itself, or TrackingError where fields contradict each other."""
        super().checked()
        self.fusion.checked()
        if len(set(self.peers)) != len(self.peers):
            raise TrackingError(f'`peers` {list(self.peers)} names an estimator twice')
        return self

    @property
    def all_peers(self) -> tuple[int, ...]:
        """Every estimator whose local estimate goes into the fused one, ascending."""
        return tuple(sorted({*self.peers, self.id}))


def make_estimator(config: EstimatorConfig, anchors: Anchors) -> tuple[LocalEstimator, Fuser]:
    """The filter (over the nodes that it hears) and the fusion rule of one estimator."""
    anchors, radio_map = calibrated(config.channel, anchors)
    heard = anchors.select(config.nodes) if config.nodes else anchors
    local = LocalEstimator(config.checked(), heard, config.id, radio_map)
    return local, Fuser(config.fusion, f'fused_{config.id}', config.area)

"""Parameters of consensus_node."""

from __future__ import annotations

from dataclasses import dataclass

from wsn_tracking.errors import TrackingError
from wsn_tracking.node_parameters.common import AssemblyConfig
from wsn_tracking.parameters import param
from wsn_tracking.trackers.consensus_config import ConsensusConfig


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
        0.0, 'how long a round may last, on the average of those so far; 0: 0.4 T / `rounds`', 's', 0.0, 3600.0
    )
    head_start: float = param(
        0.0,
        'how much longer the first round may last, since processes do not begin an epoch at once; 0: 0.2 T',
        's',
        0.0,
        3600.0,
    )

    @property
    def longest_round(self) -> float:
        """The round timeout that counts [s]."""
        return self.round_timeout or 0.4 * self.period / max(self.rounds, 1)

    @property
    def longest_start(self) -> float:
        """The head start that counts [s]."""
        return self.head_start or 0.2 * self.period

    def checked(self) -> ConsensusNodeConfig:
        """Itself, or TrackingError where fields contradict each other."""
        super().checked()
        if self.neighbours and len(self.ids) != 1:
            raise TrackingError(
                f'`neighbours` {list(self.neighbours)} are of one node, but `ids` names {list(self.ids) or "none"}: '
                'set `ids` to that node, or leave `neighbours` empty and set `radius`'
            )
        return self

"""What a simulated sink's nodes measure of d_phase while its second robot drives by the sink's position feedback."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import Floats
from wsn_tracking.parameters import group, param
from wsn_tracking.simulation import d_cells
from wsn_tracking.simulation.d_cells import CellsConfig, Ranging
from wsn_tracking.simulation.driven import FIRST, SECOND, DrivenRobot, FollowConfig
from wsn_tracking.zstack.downlink import Told
from wsn_tracking.zstack.readings import AirEpoch, Reading
from wsn_tracking.zstack.records import FeedbackRecord

Sample = tuple[float, Floats]  # time [s] since the first request, state [x, y, vx, vy]


@dataclass(frozen=True)
class DrivenConfig:
    """A robot that drives by what the sink tells it."""

    on: bool = param(False, 'd_phase in the place of a scenario: its second robot drives by the position feedback')
    behind: float = param(2.0, 'how far the second robot is behind at first', 'rad', -3.14, 3.14)
    cells: CellsConfig = group(CellsConfig)
    robot: FollowConfig = group(FollowConfig)


class DrivenAir:
    """Ranges of both robots, a request of each a period, where they are when it is made.

    `rate` is how much faster than the clock the world goes, as of the sink. TrackingError for 0: without a clock
    nothing comes in time.
    """

    def __init__(self, config: DrivenConfig, seed: int, rate: float = 1.0) -> None:
        if not rate:
            raise TrackingError('a robot is driven in some time: expected a `rate` above 0')
        self._config, self._seed, self._rate = config, seed, rate
        self._first = d_cells.d_phase(config.cells).truth
        self._second = DrivenRobot(config.robot, -config.behind)
        self._ranging = {target: Ranging(config.cells) for target in (FIRST, SECOND)}
        self._begun: float | None = None
        self.heard = 0  # feedback of either robot
        self.samples: dict[int, deque[Sample]] = {FIRST: deque(), SECOND: deque()}
        self.anchors = d_cells.nodes()

    @property
    def epochs(self) -> list[AirEpoch]:
        """All requests; what is measured is known once they are made."""
        unknown = tuple(Reading(node, range_m=0.0) for node in self.anchors.ids.tolist())
        times = np.arange(len(self._first)) * self._config.cells.period
        return [AirEpoch(t, target, k, unknown) for k, t in enumerate(times.tolist()) for target in (FIRST, SECOND)]

    def measure(self, epoch: AirEpoch, now: float, told: Iterable[Told]) -> AirEpoch:
        """The range of a request that is made `now`, after what the sink has told the robots by then."""
        if self._begun is None:
            self._begun = now - epoch.time_s / self._rate
        for time_s, _, record in told:
            if isinstance(record, FeedbackRecord):
                self.heard += 1
                at = (time_s - self._begun) * self._rate
                self._second.hear(record.robot_id, np.array([record.x, record.y]), at)
        self._second.advance(epoch.time_s)
        state = self._first[epoch.request_seq] if epoch.robot_id == FIRST else self._second.state
        self.samples[epoch.robot_id].append((epoch.time_s, state))
        draws = d_cells.draws(self._seed, epoch.robot_id, epoch.request_seq)
        row, z = self._ranging[epoch.robot_id].step(epoch.request_seq, state, *draws)
        reading = Reading(int(self.anchors.ids[row]), range_m=float(z), sigma=self._config.cells.range_std)
        return epoch._replace(readings=() if np.isnan(z) else (reading,))

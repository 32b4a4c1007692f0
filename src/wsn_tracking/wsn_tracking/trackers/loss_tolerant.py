"""System E: a cubature Kalman filter of turning targets that tolerates the loss of packets (seed 004)."""

from __future__ import annotations

import math
from collections import Counter, deque
from collections.abc import Iterable, Mapping
from itertools import compress
from typing import Any

import numpy as np

from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.robust import gated
from wsn_tracking.filters.start import Sight, area_of, likelihood_start
from wsn_tracking.models.anchors import Anchors
from wsn_tracking.models.motion import TURNING_STATES
from wsn_tracking.models.region import region_of
from wsn_tracking.sensing.average import usable, without_bearings
from wsn_tracking.sensing.channel_file import calibrated
from wsn_tracking.sensing.values import Epoch, Measurement
from wsn_tracking.trackers.estimate import Estimate, Kind
from wsn_tracking.trackers.loss_tolerant_config import LossTolerantConfig
from wsn_tracking.trackers.random_q import keep_inside
from wsn_tracking.trackers.random_q_config import UpdateConfig
from wsn_tracking.trackers.readings import MeasurementTable, Readings
from wsn_tracking.trackers.turning import filter_of, with_turn

OUTPUT = 'loss_tolerant'
RUNAWAY = 10.0  # times the standard deviation of a starting velocity: no target
MEMORY = 0.05  # weight of an epoch in the share of packets that arrive


class LossTolerantTracker:
    """One `step` an epoch, whatever arrived: a lost reading is a masked row, an epoch of none a prediction.

    A reading is lost (gamma = 0) when it is not in the epoch that its deadline closed. `counters` tells what was
    dropped (`invalid` numbers, an `unknown_node`, `gated`), how often a stamp fell (`stamp_fell`), and tracks given up
    (`reacquired_after_silence`, `reacquired_after_rejects`, `reacquired_after_divergence`).
    """

    outputs = (OUTPUT,)

    def __init__(self, config: LossTolerantConfig, anchors: Anchors) -> None:
        self.config = config.checked()
        anchors, radio_map = calibrated(config.channel, anchors)
        self._known = frozenset(anchors.ids.tolist())
        self._table = MeasurementTable(
            anchors, config.target_height, UpdateConfig(range_std=config.update.range_std), radio_map
        )
        self._area = tuple(config.area) or area_of(anchors)
        x_min, y_min, x_max, y_max = region_of(self._area).box
        self._wide = max(x_max - x_min, y_max - y_min)
        self._filter = filter_of(config)
        self.counters: Counter[str] = Counter()
        self.reset()

    def reset(self) -> None:
        """Forget the past: as after a start."""
        start = self.config.start
        self._sights: deque[tuple[int, Sight]] = deque()
        self._last: dict[int, Measurement] = {}  # hold: the last value of each node
        self._starting = start.kind == 'likelihood'
        self._belief = self._turning(Belief(np.array(start.mean), np.diag(np.array(start.std))))
        self._stamp_ns: int | None = None
        self._ahead = 0.0  # [s] since something was heard
        self._rejects = 0
        self._arriving = math.nan
        self._all_lost = 0

    def step(self, epoch: Epoch) -> tuple[Estimate, ...]:
        """Predict to the epoch and update with what of it has arrived."""
        readings = self._read(epoch)
        elapsed = self._elapsed(epoch.stamp_ns)
        dt = min(elapsed, max(self.config.turn.horizon - self._ahead, 0.0))
        self._ahead += elapsed
        silence = self.config.reacquire.silence
        if readings.ids and not self._starting and silence and self._ahead > silence:
            self._start_anew('reacquired_after_silence')
        kind, used = Kind.START, readings.ids
        if not self._starting:
            kind, used = Kind.LOCAL, self._track(dt, readings)
        if self._starting:
            self._belief, kind, used = self._find_start(epoch.stamp_ns, readings), Kind.START, readings.ids
        if used:
            self._ahead = 0.0
        self._stamp_ns = epoch.stamp_ns
        m, P = self._belief.m, self._belief.P
        names = {'kind': kind, 'state_names': TURNING_STATES, 'measurements': used}
        return (Estimate(epoch.stamp_ns, epoch.target_id, epoch.request_seq, OUTPUT, m, P, **names),)  # type: ignore[arg-type]

    def state(self) -> Mapping[str, Any]:
        """How it is: whether there is a track, how long nothing was heard [s], what share of the nodes arrives.

        `all_lost` counts the epochs in which nothing did.
        """
        return {
            'tracking': not self._starting,
            'silent_s': self._ahead,
            'arriving': self._arriving,
            'all_lost': self._all_lost,
        }

    # ---- what arrived

    def _read(self, epoch: Epoch) -> Readings:
        """The readings of an epoch over all nodes; `hold` fills in what a lost node told last."""
        packets = without_bearings(epoch).measurements
        known = [p for p in packets if p.node_id in self._known]
        arrived = [p for p in known if usable(p)]
        self._count('unknown_node', len(packets) - len(known))
        self._count('invalid', len(known) - len(arrived))
        self._all_lost += not arrived
        share = len({p.node_id for p in arrived}) / len(self._known)
        self._arriving = share if math.isnan(self._arriving) else (1 - MEMORY) * self._arriving + MEMORY * share
        if self.config.filter != 'hold':
            return self._readings(epoch, arrived)
        self._last.update((p.node_id, p) for p in arrived)
        heard = tuple(p.node_id for p in arrived)
        return self._readings(epoch, [self._last[node] for node in sorted(self._last)])._replace(ids=heard)

    def _readings(self, epoch: Epoch, packets: Iterable[Measurement]) -> Readings:
        return self._table.read(epoch._replace(measurements=tuple(packets)))

    def _elapsed(self, stamp_ns: int) -> float:
        """Time since the last epoch [s]; none where a stamp falls."""
        if self._stamp_ns is None:
            return 0.0
        self._count('stamp_fell', int(stamp_ns < self._stamp_ns))
        return max(stamp_ns - self._stamp_ns, 0) * 1e-9

    def _count(self, reason: str, times: int) -> None:
        if times:
            self.counters[reason] += times

    # ---- tracking

    def _track(self, dt: float, readings: Readings) -> tuple[int, ...]:
        """Move the belief on; the nodes whose readings were used."""
        predicted = self._filter.predict(self._belief, dt)
        z, h, noise, used = self._gate(predicted, readings)
        updated = keep_inside(self._filter.update(predicted, z, h, noise), self.config.area)
        self._belief = self._no_wider_than_the_area(updated) if used else updated
        rejects = self.config.reacquire.rejects
        if self._is_nowhere(self._belief):
            self._start_anew('reacquired_after_divergence')
        elif rejects and self._rejects >= rejects:
            self._start_anew('reacquired_after_rejects')
        return used

    def _no_wider_than_the_area(self, belief: Belief) -> Belief:
        """The belief, with less uncertainty where its position is known to less than the longer side of the area.

        The points of a rule that is wider than the field lie beyond all nodes, which then read the same at each: the
        readings tell nothing, and the covariance grows from epoch to epoch, about a node that stands alone for ever.
        """
        spread = float(np.linalg.norm(belief.chol_P[:2]))
        if spread <= self._wide:
            return belief
        chol_P = belief.chol_P.copy()
        chol_P[:4] *= self._wide / spread
        return Belief(belief.m, chol_P)

    def _is_nowhere(self, belief: Belief) -> bool:
        """Whether a filter has run away: off the area by more than its size, or faster than anything that starts here.

        It happens after long silence, when readings are far from linear over what is possible.
        """
        m = belief.m
        x_min, y_min, x_max, y_max = region_of(self._area).box
        wide = self._wide
        near = x_min - wide <= m[0] <= x_max + wide and y_min - wide <= m[1] <= y_max + wide
        return not (near and math.hypot(m[2], m[3]) <= RUNAWAY * self.config.start.speed)

    def _gate(self, predicted: Belief, readings: Readings) -> Readings:
        """The readings without those that are too far from their prediction, which are counted."""
        if not (self.config.robust.gate and readings.ids):
            return readings
        r = self._filter.regress(predicted, readings.h)
        z = gated(readings.z, r, readings.noise(predicted.m[None, :])[0], self.config.robust.gate)
        kept = ~np.isnan(z[self._table.anchors.rows(readings.ids)])
        rejected = len(readings.ids) - int(kept.sum())
        self._count('gated', rejected)
        self._rejects = self._rejects + 1 if 2 * rejected > len(readings.ids) else 0
        return readings._replace(z=z, ids=tuple(compress(readings.ids, kept)))

    # ---- the start

    def _start_anew(self, why: str) -> None:
        self.counters[why] += 1
        self._sights.clear()
        self._rejects = 0
        self._starting = True

    def _find_start(self, stamp_ns: int, readings: Readings) -> Belief:
        """The likelihood over the area of all that was heard so far; ends with the epoch that completes it."""
        if readings.ids:
            self._sights.append((stamp_ns, Sight(0.0, readings.z, readings.h, readings.noise)))
        aged = [s._replace(age=max(stamp_ns - then, 0) * 1e-9) for then, s in self._sights]
        self._starting = len(self._sights) < self.config.start.epochs
        planar = likelihood_start(aged, self._area, self.config.start.speed)
        return keep_inside(self._turning(planar), self.config.area)

    def _turning(self, planar: Belief) -> Belief:
        return with_turn(planar, math.radians(self.config.start.turn))

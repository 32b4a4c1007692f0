"""System D: least squares and extended Kalman filter together (seed 001), one tracker a target."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import Any

import numpy as np

from wsn_tracking.errors import TrackingError
from wsn_tracking.filters.ekf import Gaussian
from wsn_tracking.filters.start import Area, area_of
from wsn_tracking.models.anchors import Anchors
from wsn_tracking.sensing.channel import calibrated
from wsn_tracking.sensing.values import Epoch
from wsn_tracking.trackers import hybrid_steps as steps
from wsn_tracking.trackers.estimate import Estimate, Kind
from wsn_tracking.trackers.hybrid_config import HybridConfig
from wsn_tracking.trackers.hybrid_readings import Distance, DistanceTable
from wsn_tracking.trackers.hybrid_search import Search


class HybridTracker:
    """One track of one target: one `step` an epoch, whatever was heard.

    Ranges are taken one at a time in the order of their stamps; the estimate is at the epoch's. Until the target is
    found, and again once nothing of it was usable for `stale` seconds, estimates are of Kind.START: all that is known.
    """

    def __init__(self, config: HybridConfig, anchors: Anchors, target_id: int) -> None:
        self.config = config.checked()
        self.target_id = target_id
        self.outputs = (f'hybrid_target_{target_id}',)
        anchors, _ = calibrated(config.channel, anchors)
        self.table = DistanceTable(anchors, config.range_std)
        self._places = anchors.positions - np.array([0.0, 0.0, config.target_height])
        self._area: Area = (*config.area,) if config.area else area_of(anchors)  # type: ignore[assignment]
        self.counters: Counter[str] = Counter()
        self.reset()

    def reset(self) -> None:
        """Forget the past: as after a start."""
        self._begun_ns: int | None = None  # times below count from here [s]
        self._track: steps.Track | None = None
        self._search = Search(self.config, self._places, self._area)
        self._t = self._heard = 0.0  # of the belief; of the last range that was used
        self._rejects = 0
        self._found_before = False

    def state(self) -> Mapping[str, Any]:
        """What diagnostics tell."""
        return {
            'phase': 'tracking' if self._track is not None else ('lost' if self._found_before else 'starting'),
            'hypotheses': 1 if self._track is not None else self._search.count,
            'gated in a row': self._rejects,
        }

    def step(self, epoch: Epoch) -> tuple[Estimate, ...]:
        """Take in the ranges of an epoch; an empty epoch predicts. Raises TrackingError for another target's."""
        if epoch.target_id != self.target_id:
            raise TrackingError(
                f'an epoch of target {epoch.target_id} was given to the tracker of target {self.target_id}: '
                'every target has a tracker of its own'
            )
        if self._begun_ns is None:
            self._begun_ns = epoch.stamp_ns
        used = tuple(sorted({d.node_id for d in self._heard_in(epoch)}))
        now = self._seconds(epoch.stamp_ns)
        self._lose_if_stale(now)
        belief, kind = self._belief_at(now)
        return (
            Estimate(
                epoch.stamp_ns, epoch.target_id, epoch.request_seq, self.outputs[0], belief.m, belief.P, (), used,
                kind=kind,
            ),
        )  # fmt: skip

    def _heard_in(self, epoch: Epoch) -> list[Distance]:
        """The ranges of an epoch that were used."""
        used = []
        for distance in self.table.read(epoch, self.counters):
            t = self._seconds(distance.stamp_ns)
            if t < self._t - self.config.stale:
                self.counters['late'] += 1
                continue
            self._lose_if_stale(t)
            if self._follow(distance, max(t, self._t)) if self._track is not None else self._look(distance, t):
                used.append(distance)
        return used

    def _follow(self, distance: Distance, t: float) -> bool:
        """Go on with one range; whether it was used."""
        assert self._track is not None
        track = steps.predict(self._track, t - self._t, self.config)
        reading = steps.reading_of(distance.z, distance.row, distance.std, distance.share)
        self._track, outcome = steps.hear(track, reading, t, self._places, self.config)
        self._t = t
        self.counters['manoeuvre'] += int(outcome.manoeuvre)
        if outcome.gated:
            self.counters['gated'] += 1
            self._rejects += 1
            if self.config.robust.rejects and self._rejects >= self.config.robust.rejects:
                self._lose('rejected')
            return False
        self._heard, self._rejects = t, 0
        return True

    def _look(self, distance: Distance, t: float) -> bool:
        """Search on with one range."""
        t = max(t, self._t)
        found = self._search.hear(distance, t)
        self._t = self._heard = t
        if found is not None:
            self._track = steps.begin(found, len(self._places), self.config)
            self._rejects = 0
            self.counters['reacquired' if self._found_before else 'started'] += 1
            self._found_before = True
        return True

    def _lose_if_stale(self, t: float) -> None:
        if self._track is not None and t - self._heard > self.config.stale:
            self._lose('stale')

    def _lose(self, why: str) -> None:
        """Give the track up, and look for the target anew."""
        assert self._track is not None
        self.counters[why] += 1
        self._search = Search(self.config, self._places, self._area, self._track.belief, self._t)
        self._track = None

    def _belief_at(self, t: float) -> tuple[Gaussian, Kind]:
        if self._track is None:
            return self._search.belief_at(t), Kind.START
        return steps.predict(self._track, t - self._t, self.config).belief, Kind.LOCAL

    def _seconds(self, stamp_ns: int) -> float:
        assert self._begun_ns is not None
        return (stamp_ns - self._begun_ns) * 1e-9

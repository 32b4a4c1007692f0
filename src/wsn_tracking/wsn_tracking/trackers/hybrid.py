"""System D: least squares and extended Kalman filter together (seed 001), one tracker a target."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from typing import Any

import numpy as np

from wsn_tracking.errors import TrackingError
from wsn_tracking.filters.ekf import Gaussian
from wsn_tracking.filters.start import area_of
from wsn_tracking.models.anchors import Anchors, Floats
from wsn_tracking.models.motion import constant_velocity
from wsn_tracking.models.region import region_of
from wsn_tracking.sensing.average import without_bearings
from wsn_tracking.sensing.channel_file import calibrated
from wsn_tracking.sensing.values import Epoch
from wsn_tracking.trackers import hybrid_literal as literal
from wsn_tracking.trackers import hybrid_steps as steps
from wsn_tracking.trackers.estimate import Estimate, Kind
from wsn_tracking.trackers.hybrid_config import HybridConfig
from wsn_tracking.trackers.hybrid_listening import reading_of
from wsn_tracking.trackers.hybrid_readings import Distance, DistanceTable
from wsn_tracking.trackers.hybrid_search import Search

FORGET = 1.0 / 16.0  # weight of the newest range in what is averaged over ranges
DOUBT = 0.1  # share of gated ranges from which on a track that fell silent is not trusted
PATIENCE = 4.0  # periods without a range that no track minds


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
        self._area = region_of(config.area or area_of(anchors)).box
        self._stale = max(config.stale, PATIENCE * config.period)
        self.counters: Counter[str] = Counter()
        self.reset()

    def reset(self) -> None:
        """Forget the past: as after a start."""
        self._begun_ns: int | None = None  # times below count from here [s]
        self._track: steps.Track | literal.LiteralTrack | None = None
        self._instants = literal.Instants(self.target_id)
        self._search = Search(self.config, self._places, self._area)
        self._t = self._heard = -math.inf  # of the belief; of the last range that was used
        self._rejects, self._misfit = 0.0, 1.0
        self._found_before = False

    def state(self) -> Mapping[str, Any]:
        """What diagnostics tell."""
        return {
            'phase': 'tracking' if self._track is not None else ('lost' if self._found_before else 'starting'),
            'hypotheses': 1 if self._track is not None else self._search.count,
            'gated lately': self._rejects,
            'misfit': self._misfit,
        }

    def predicted(self, stamp_ns: int) -> Floats | None:
        """Where the target will be [x, y, vx, vy] at a stamp; None while it is looked for."""
        if self._track is None:
            return None
        belief, _ = self._belief_at(self._seconds(stamp_ns))
        return belief.m

    def step(self, epoch: Epoch) -> tuple[Estimate, ...]:
        """Take in the ranges of an epoch; an empty epoch predicts. Raises TrackingError for another target's."""
        if epoch.target_id != self.target_id:
            raise TrackingError(
                f'an epoch of target {epoch.target_id} was given to the tracker of target {self.target_id}: '
                'every target has a tracker of its own'
            )
        epoch = without_bearings(epoch)
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
        used: list[Distance] = []
        told = self.table.read(epoch, self.counters)
        # at a time one range is taken, or all of the epoch (literal)
        for group in self._instants.of(told) if self.config.form == 'literal' else [[distance] for distance in told]:
            t = self._seconds(group[0].stamp_ns)
            if t < self._t - self._stale:
                self.counters['late'] += len(group)
                continue
            self._lose_if_stale(t)
            if self._track is not None:
                used += self._follow(group, max(t, self._t))
            else:
                used += [distance for distance in group if self._look(distance, max(t, self._t))]
        return used

    def _follow(self, group: list[Distance], t: float) -> list[Distance]:
        """Go on with ranges of one instant; those that were used."""
        track = self._predicted(t)
        self._t = t
        outcome: steps.Outcome | literal.Heard
        if isinstance(track, literal.LiteralTrack):
            z, std, share = np.full((3, len(self._places)), np.nan)
            rows = [distance.row for distance in group]
            z[rows], std[rows], share[rows] = np.array([(d.z, d.std, d.share) for d in group]).T
            self._track, outcome = literal.hear(track, z, std, share, t, self._places, self.config)
            gated = outcome.gated[rows].tolist()
        else:
            reading = reading_of(group[0].z, group[0].row, group[0].std, group[0].share)
            self._track, outcome = steps.hear(track, reading, t, self._places, self.config)
            gated = [bool(outcome.gated)]
        self.counters['manoeuvre'] += int(outcome.manoeuvre)
        self.counters['gated'] += sum(gated)
        used = [distance for distance, out in zip(group, gated, strict=True) if not out]
        self._judge(gated, float(outcome.squared))
        self._heard = t if used else self._heard
        return used

    def _judge(self, gated: list[bool], squared: float) -> None:
        """Give up a track that most ranges, or those that it takes, do not fit."""
        for out in gated:
            self._rejects += FORGET * (out - self._rejects)
        if not all(gated):
            self._misfit += FORGET * (squared - self._misfit)
        robust = self.config.robust
        if self._rejects > robust.rejects:
            self._lose('rejected')
        elif robust.misfit and self._misfit > robust.misfit:
            self._lose('misfit')

    def _look(self, distance: Distance, t: float) -> bool:
        """Search on with one range; whether it was used (a track that it begins has it)."""
        found = self._search.hear(distance, t)
        self._t = self._heard = t
        if found is not None and self._track is None:
            begin = literal.begin(found, len(self._places)) if self.config.form == 'literal' else None
            self._track = begin or steps.begin(found, len(self._places), self.config)
            self._rejects, self._misfit = 0.0, 1.0
            self.counters['reacquired' if self._found_before else 'started'] += 1
            self._found_before = True
        return True

    def _lose_if_stale(self, t: float) -> None:
        if self._track is not None and t - self._heard > self._stale:
            self._lose('stale')

    def _lose(self, why: str) -> None:
        """Give the track up, and look for the target anew: elsewhere, if what was heard last did not fit."""
        assert self._track is not None
        self.counters[why] += 1
        last = self._track.belief
        if why != 'stale' or self._rejects > DOUBT:
            last = last._replace(P=last.P + self.config.start.P0)
        self._search = Search(self.config, self._places, self._area, last, self._t)
        self._track = None

    def _belief_at(self, t: float) -> tuple[Gaussian, Kind]:
        if self._track is None:
            return self._search.belief_at(t), Kind.START
        if t < self._t:  # ranges that came after the epoch's stamp: back along the velocity
            m, P = self._track.belief
            F = constant_velocity(t - self._t)
            return Gaussian(F @ m, F @ P @ F.T), Kind.LOCAL
        return self._predicted(t).belief, Kind.LOCAL

    def _predicted(self, t: float) -> steps.Track | literal.LiteralTrack:
        assert self._track is not None
        if isinstance(self._track, literal.LiteralTrack):
            return literal.predict(self._track, t - self._t, self.config)
        return steps.predict(self._track, t - self._t, self.config)

    def _seconds(self, stamp_ns: int) -> float:
        assert self._begun_ns is not None
        return (stamp_ns - self._begun_ns) * 1e-9

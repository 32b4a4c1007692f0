"""System C: a person who wears a node, tracked by a particle filter (seed 003)."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from wsn_tracking.errors import TrackingError
from wsn_tracking.filters.ancestry import Ancestry
from wsn_tracking.filters.resampling import systematic
from wsn_tracking.filters.start import area_of
from wsn_tracking.models.anchors import Anchors, Floats
from wsn_tracking.models.draws import Stream
from wsn_tracking.models.map_excess import with_map
from wsn_tracking.models.region import Region, region_of
from wsn_tracking.models.walk import PLANAR, PSI, YAW
from wsn_tracking.sensing.channel_file import body_of, calibrated
from wsn_tracking.sensing.floor_plan import read_floor_plan
from wsn_tracking.sensing.values import Epoch
from wsn_tracking.trackers.estimate import Estimate, Kind
from wsn_tracking.trackers.human_config import HumanConfig
from wsn_tracking.trackers.human_filter import FLOOR, HumanFilter, Step
from wsn_tracking.trackers.human_places import Area
from wsn_tracking.trackers.human_readings import SignalTable
from wsn_tracking.trackers.human_report import HumanReport

HUMAN = 2**34  # the stream of draws of this tracker
FIRST = -1  # its epoch for the particles that it begins with


class Particles(NamedTuple):
    """What there is to draw."""

    positions: Floats  # (P, 2) [m]
    facing: Floats  # (P,) [rad] where the chest faces
    weights: Floats  # (P,)


class HumanTracker:
    """One person: one `step` an epoch, whatever was heard."""

    def __init__(self, config: HumanConfig, anchors: Anchors) -> None:
        self.config = config.checked()
        anchors, radio_map = calibrated(config.channel, anchors)
        if radio_map is not None:
            anchors, radio_map = with_map(anchors, radio_map)
        self.anchors = anchors
        self.outputs: tuple[str, ...] = ('human', 'human_lag') if config.lag else ('human',)
        self.counters: Counter[str] = Counter()
        floor = read_floor_plan(config.floor_plan) if config.floor_plan else None
        if floor is None and len(config.area) > 4:
            floor = region_of(tuple(config.area))
        box = _box(tuple(config.area), floor, anchors)
        self._filter = HumanFilter(config, anchors, box, floor, radio_map)
        self._table = SignalTable(config, anchors, self.counters, body_of(config.channel))
        self._draws = Stream(config.seed, HUMAN)
        self._past = Ancestry(config.lag)
        self.reset()

    def reset(self) -> None:
        """Forget the past: as after a start."""
        self._track = self._filter.begin((), self._draws.at(FIRST))
        self._stamp_ns: int | None = None
        self._begun_ns: int | None = None  # stamp of the epoch that time in `_past` is counted from
        self._heard = False
        self._last: Step | None = None
        self._epoch: Epoch | None = None
        self._past.clear()

    def step(self, epoch: Epoch) -> tuple[Estimate, ...]:
        """Predict to the epoch, weigh the particles by what it holds, estimate, resample: one estimate an output."""
        generator = self._draws.at(epoch.request_seq)
        readings, ids = self._table.read(epoch)
        dt = 0.0 if self._stamp_ns is None else (epoch.stamp_ns - self._stamp_ns) * 1e-9
        if dt > self.config.start.gap:
            self.counters['started_after_gap'] += 1
            self.reset()
            generator, dt = self._draws.at(epoch.request_seq), 0.0
        step = self._filter.step(self._track, dt, readings, generator)
        self.counters['reset'] += int(step.reset)
        self._track, self._last, self._epoch = step.track, step, epoch
        self._stamp_ns = max(epoch.stamp_ns, self._stamp_ns or epoch.stamp_ns)
        self._heard = self._heard or bool(ids)
        kind = Kind.LOCAL if self._heard else Kind.START
        estimate = Estimate(
            epoch.stamp_ns,
            epoch.target_id,
            epoch.request_seq,
            'human',
            step.mean,
            step.covariance,
            measurements=ids,
            kind=kind,
        )
        return (estimate, self._lagged(estimate, step)) if self.config.lag else (estimate,)

    def _lagged(self, now: Estimate, step: Step) -> Estimate:
        """Where he was `lag` seconds ago, by the paths of today's particles; START until they reach back so far."""
        if self._begun_ns is None:
            self._begun_ns = now.stamp_ns
        time = ((self._stamp_ns or now.stamp_ns) - self._begun_ns) * 1e-9
        self._past.add(time, step.cloud.s[PLANAR], step.covariance, step.parents)
        then = time - self.config.lag
        mean, covariance = self._past.moments(then, step.cloud.w, FLOOR)
        kind = Kind.SMOOTHED if self._heard and self._past.before(then) else Kind.START
        stamp_ns = now.stamp_ns - round(self.config.lag * 1e9)
        return now._replace(stamp_ns=stamp_ns, source='human_lag', mean=mean, covariance=covariance, kind=kind)

    @property
    def particles(self) -> Particles:
        """The particles of the last estimate."""
        cloud = self._track.cloud if self._last is None else self._last.cloud
        return Particles(np.ascontiguousarray(cloud.s[:2].T), cloud.s[PSI] + cloud.s[YAW], cloud.w)

    def equal_particles(self) -> Particles:
        """As many of the same weight, for whoever draws without weights; no draw of the tracker is used."""
        places, facing, w = self.particles
        kept = systematic(w, w.size, np.random.default_rng(0))
        return Particles(places[kept], facing[kept], np.full(w.size, 1.0 / w.size))

    def report(self) -> HumanReport | None:
        """What the last epoch tells beside its estimates; None before the first."""
        if self._last is None or self._epoch is None:
            return None
        last, epoch = self._last, self._epoch
        heard = ~np.isnan(last.readings.z)
        by_node = self._filter.evidence_by_node(last)
        facing = last.cloud.s[PSI] + last.cloud.s[YAW]
        c, s = (float(f(facing) @ last.cloud.w) for f in (np.cos, np.sin))
        return HumanReport(
            epoch.stamp_ns,
            epoch.target_id,
            epoch.request_seq,
            heading=math.atan2(s, c),
            heading_known=math.hypot(c, s),
            speed=math.hypot(*last.mean[2:].tolist()),
            particles=last.cloud.log_w.size,
            n_eff=float(last.n_eff),
            log_evidence=float(last.evidence),
            node_ids=tuple(self.anchors.ids[heard].tolist()),
            node_log_evidences=tuple(by_node[heard].tolist()),
            reset=bool(last.reset),
            resets=self.counters['reset'],
        )

    def state(self) -> Mapping[str, Any]:
        """The same for diagnostics."""
        report = self.report()
        if report is None:
            return {'particles': self.config.particles, 'n_eff': float(self.config.particles), 'reset': False}
        told = report._asdict()
        nodes = (told.pop(name) for name in ('node_ids', 'node_log_evidences'))
        for name in ('stamp_ns', 'target_id', 'request_seq', 'resets'):  # the node and its counters tell them
            del told[name]
        return {**told, 'evidence': dict(zip(*nodes, strict=True))}


def _box(area: tuple[float, ...], floor: Region | None, anchors: Anchors) -> Area:
    """The rectangle round where a person can be: both area and floor plan bound it, where both are given.

    Raises TrackingError where they have nothing in common.
    """
    boxes = [region_of(area).box] if area else []
    boxes += [floor.box] if floor is not None else []
    if not boxes:
        boxes = [region_of(area_of(anchors)).box]
    low = [max(box[i] for box in boxes) for i in (0, 1)]
    high = [min(box[i] for box in boxes) for i in (2, 3)]
    if low[0] >= high[0] or low[1] >= high[1]:
        raise TrackingError(
            f'`area` {list(area)} and the floor plan, which lies within {list(boxes[-1])}, have nothing in common: '
            'give both in metres of one frame, or one of them'
        )
    return low[0], low[1], high[0], high[1]

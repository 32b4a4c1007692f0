"""System A: random-Q square-root cubature Kalman filters (seed 000, section 2.1), one an estimator."""

from __future__ import annotations

from collections import Counter
from itertools import compress

import numpy as np

from wsn_tracking.filters import srckf
from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.linalg import tria
from wsn_tracking.filters.robust import gated, student_t, with_offsets
from wsn_tracking.filters.start import area_of
from wsn_tracking.models.anchors import Anchors, Floats
from wsn_tracking.models.draws import Stream
from wsn_tracking.models.measurement import POSITION, Function
from wsn_tracking.models.motion import constant_velocity, forgetful_velocity
from wsn_tracking.models.noise import scaled_identity
from wsn_tracking.models.offsets import drift
from wsn_tracking.models.radio_map import RadioMap
from wsn_tracking.models.region import kept_inside
from wsn_tracking.sensing.values import Epoch
from wsn_tracking.trackers.estimate import PLANAR_STATES, Estimate, Kind
from wsn_tracking.trackers.lookback import Lookback
from wsn_tracking.trackers.random_q_config import NoiseConfig, RandomQConfig
from wsn_tracking.trackers.readings import MeasurementTable, Readings

ESTIMATORS = 2**33  # an estimator's stream of draws is this plus its number; a sensing node's is its id
PLANAR = len(PLANAR_STATES)
WHITE = 0.25  # least share of a link's noise that stays white beside its drifting offset


def motion_of(config: NoiseConfig, q: Floats, dt: float) -> tuple[Floats, Floats]:
    """F (4, 4) and chol_Q (..., 4, 4) for drawn q (...) and a step of dt [s]; nothing happens in no time."""
    if dt <= 0.0:
        return np.eye(4), np.zeros((*np.shape(q), 4, 4))
    if config.kind == 'identity':
        return constant_velocity(dt), scaled_identity(q)
    F, chol_Q = forgetful_velocity(config.spectral_density, dt, config.velocity_time)
    factor = 2.0 * np.asarray(q) / (config.q_min + config.q_max)
    return F, factor[..., None, None] * chol_Q


def random_q_step(
    belief: Belief,
    dt: float,
    q: Floats,
    z: Floats,
    h: Function,
    noise: Function,
    config: RandomQConfig,
) -> Belief:
    """Algorithm 1 of seed 000: predict by dt [s] with the drawn q (...), update with z (..., N), keep inside."""
    return update_step(predict_step(belief, dt, q, config), z, h, noise, config)


def predict_step(belief: Belief, dt: float, q: Floats, config: RandomQConfig) -> Belief:
    """Time update by dt [s] with the drawn q (...); offsets, where the belief has them, drift."""
    F, chol_Q = motion_of(config.noise, q, dt)
    links = belief.m.shape[-1] - PLANAR
    if links and dt > 0.0:
        F, chol_Q = drift(F, chol_Q, dt, np.full(links, config.robust.offset_std), config.robust.offset_time)
    elif links:
        return belief
    return srckf.predict(belief, F, chol_Q)


def update_step(predicted: Belief, z: Floats, h: Function, noise: Function, config: RandomQConfig) -> Belief:
    """Measurement update with z (..., N), NaN where nothing was heard; the position stays in the area."""
    links = predicted.m.shape[-1] - PLANAR
    root = white_part(noise, config.robust.offset_std) if links else noise
    if config.robust.dof:
        root = student_t(root, z, read_function(h, links), config.robust.dof)
    passes = 1 if config.update.kind == 'ckf' else config.update.passes
    updated = srckf.update(predicted, z, h, root, passes, config.update.kappa, links, POSITION)
    return keep_inside(updated, config.area)


def read_function(h: Function, links: int) -> Function:
    """What the nodes read at a state: h, and behind the planar states an offset a link."""
    return (lambda x: h(x[..., :PLANAR]) + x[..., PLANAR:]) if links else h


def white_part(noise: Function, offset_std: float) -> Function:
    """Root of the noise that is left beside an offset of that standard deviation."""
    return lambda x: np.sqrt(np.maximum(noise(x) ** 2 - offset_std**2, (WHITE * noise(x)) ** 2))


def keep_inside(belief: Belief, area: tuple[float, ...]) -> Belief:
    """The belief with its position brought into the area, where there is one."""
    if not area:
        return belief
    m = belief.m.copy()
    m[..., :2] = kept_inside(m[..., :2], area)
    return Belief(m, belief.chol_P)


class LocalEstimator:
    """Estimator `number` of system A: one `step` an epoch, whatever was heard."""

    def __init__(self, config: RandomQConfig, anchors: Anchors, number: int, radio_map: RadioMap | None = None) -> None:
        self.config = config.checked()
        self.number = number
        self._draws = Stream(config.seed, ESTIMATORS + number)
        self.table = MeasurementTable(anchors, config.target_height, config.update, radio_map)
        self._lately = Lookback(tuple(config.area) or area_of(anchors), config.start.speed)
        self.counters: Counter[str] = Counter()
        self.reset()

    def reset(self) -> None:
        """Forget the past: as after a start."""
        start = self.config.start
        self._lately.clear()
        self._starting = start.kind == 'likelihood'
        self._belief = self._extended(Belief(np.array(start.mean), np.diag(np.array(start.std))))
        self._stamp_ns: int | None = None
        self._heard_ns: int | None = None
        self._rejects = 0

    def draw(self, epoch: int) -> float:
        """q ~ U[q_min, q_max] of this estimator in that epoch."""
        noise = self.config.noise
        return self._draws.at(epoch).uniform(noise.q_min, noise.q_max)

    def step(self, epoch: Epoch) -> Estimate:
        """Predict to the epoch and update with what it holds; an empty epoch predicts."""
        readings = self.table.read(epoch)
        q = self.draw(epoch.request_seq)
        if not self._starting and self._has_been_silent(epoch, readings):
            self._start_anew('reacquired_after_silence')
        if self._starting:
            belief, kind = self._find_start(epoch.stamp_ns, readings), Kind.START
        else:
            belief, kind, readings = self._track(epoch.stamp_ns, q, readings)
        self._belief, self._stamp_ns = belief, epoch.stamp_ns
        self._heard_ns = epoch.stamp_ns if readings.ids else self._heard_ns
        planar = Belief(belief.m[:PLANAR], belief.chol_P[:PLANAR, :PLANAR])
        return Estimate(
            epoch.stamp_ns,
            epoch.target_id,
            epoch.request_seq,
            f'local_{self.number}',
            planar.m,
            planar.P,
            (self.number,),
            readings.ids,
            q,
            kind,
        )

    def feed_back(self, fused: Estimate) -> None:
        """Go on from a fused estimate instead of one's own (option `feedback`); offsets keep what is known of them."""
        m, chol_P = self._belief.m.copy(), self._belief.chol_P.copy()
        m[:PLANAR] = fused.mean
        chol_P[:PLANAR, :PLANAR] = np.linalg.cholesky(fused.covariance)
        if m.size > PLANAR:
            chol_P[PLANAR:, :] = np.concatenate(
                [np.zeros((m.size - PLANAR, PLANAR)), tria(chol_P[PLANAR:, :])], axis=-1
            )
        self._belief = Belief(m, chol_P)

    def _track(self, stamp_ns: int, q: float, readings: Readings) -> tuple[Belief, Kind, Readings]:
        """One step of the filter, or a new start where it has rejected what it hears for too long."""
        dt = 0.0 if self._stamp_ns is None else max(stamp_ns - self._stamp_ns, 0) * 1e-9
        predicted = predict_step(self._belief, dt, np.asarray(q), self.config)
        accepted = self._gate(predicted, readings)
        z, h, noise, _ = accepted
        updated = update_step(predicted, z, h, noise, self.config)
        if why := self._why_anew(stamp_ns, readings, updated):
            self.counters[why] += 1
            self._rejects = 0
            return self._found(stamp_ns), Kind.START, readings
        return updated, Kind.LOCAL, accepted

    def _why_anew(self, stamp_ns: int, readings: Readings, updated: Belief) -> str:
        """Why the track is to be found anew from what was heard lately; empty: it is not."""
        rejects, odds, window = self.config.reacquire.rejects, self.config.reacquire.odds, self.config.reacquire.window
        if not (rejects or odds):
            return ''
        self._lately.add(stamp_ns, readings, updated.m[:PLANAR])
        self._lately.keep(stamp_ns, window)
        if rejects and self._rejects >= rejects:
            return 'reacquired_after_rejects'
        return 'reacquired_elsewhere' if odds and self._lately.contradicts(stamp_ns, window, odds) else ''

    def _gate(self, predicted: Belief, readings: Readings) -> Readings:
        """The readings without those that are too far from their prediction, which are counted."""
        if not (self.config.robust.gate and readings.ids):
            return readings
        links = predicted.m.shape[-1] - PLANAR
        r = srckf.predicted_readings(predicted, predicted, readings.h, self.config.update.kappa, links, POSITION)
        root = white_part(readings.noise, self.config.robust.offset_std) if links else readings.noise
        z = gated(readings.z, r, root(predicted.m[None, :])[0], self.config.robust.gate)
        kept = ~np.isnan(z[self.table.anchors.rows(readings.ids)])
        rejected = len(readings.ids) - int(kept.sum())
        self.counters['gated'] += rejected
        self._rejects = self._rejects + 1 if 2 * rejected > len(readings.ids) else 0
        return readings._replace(z=z, ids=tuple(compress(readings.ids, kept)))

    def _has_been_silent(self, epoch: Epoch, readings: Readings) -> bool:
        silence = self.config.reacquire.silence
        if not (silence and readings.ids and self._heard_ns is not None):
            return False
        return (epoch.stamp_ns - self._heard_ns) * 1e-9 > silence

    def _start_anew(self, why: str) -> None:
        self.counters[why] += 1
        self._lately.clear()
        self._starting = True

    def _find_start(self, stamp_ns: int, readings: Readings) -> Belief:
        """The likelihood over the area of all that was heard so far; ends with the epoch that completes it."""
        self._lately.add(stamp_ns, readings, np.zeros(PLANAR))
        belief = self._found(stamp_ns)
        self._starting = len(self._lately) < self.config.start.epochs
        if not self._starting:
            self._lately.clear()
        return belief

    def _found(self, stamp_ns: int) -> Belief:
        return keep_inside(self._extended(self._lately.place(stamp_ns)), self.config.area)

    def _extended(self, belief: Belief) -> Belief:
        """The belief with an offset a link, where they are modelled."""
        std = self.config.robust.offset_std
        return with_offsets(belief, np.full(self.table.anchors.ids.size, std)) if std else belief

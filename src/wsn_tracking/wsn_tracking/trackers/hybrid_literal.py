"""System D to the letter (seed 001, section 2): all ranges of a period at once, and a gain that is frozen and fades."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wsn_tracking.errors import TrackingError
from wsn_tracking.filters import frozen_gain, manoeuvre, recent
from wsn_tracking.filters.ekf import Gaussian
from wsn_tracking.filters.recent import Recent
from wsn_tracking.models.anchors import Floats, Mask
from wsn_tracking.models.motion import forgetful_velocity
from wsn_tracking.trackers.hybrid_config import HybridConfig
from wsn_tracking.trackers.hybrid_readings import Distance

FADED = 0.05  # an extra gain below this share no longer keeps the gate open
SUMMED = 4.0  # ranges that the threshold of a manoeuvre is for: here those of one period
TOGETHER, THIN = 3, 4  # ranges of an instant, and epochs in a row with fewer that show that none will have


class Instants:
    """The ranges of an epoch, which are of one instant; TrackingError for a target whose ranges come one by one."""

    def __init__(self, target_id: int) -> None:
        self._target_id = target_id
        self._thin, self._together = 0, False  # epochs in a row with few ranges; whether one had enough

    def of(self, told: list[Distance]) -> list[list[Distance]]:
        """One group, or none where nothing was heard."""
        self._thin = 0 if len(told) >= TOGETHER else self._thin + bool(told)
        self._together |= len(told) >= TOGETHER
        if len({distance.stamp_ns for distance in told}) > 1 or (self._thin >= THIN and not self._together):
            raise TrackingError(
                f'form literal takes ranges of {TOGETHER} nodes or more at one instant, but those of target '
                f'{self._target_id} come one by one: set `form` to inflate (or decay, imm)'
            )
        return [told] if told else []


class LiteralTrack(NamedTuple):
    """All that is kept of targets."""

    belief: Gaussian  # (..., 4)
    recent: Recent
    K_z: Floats  # (..., 4, N) of the last manoeuvre
    since: NDArray[np.int64]  # (...) periods since then; -1: there was none


class Heard(NamedTuple):
    """What became of the ranges of a period."""

    accepted: Mask  # (..., N)
    gated: Mask  # (..., N)
    manoeuvre: Mask  # (...)
    squared: Floats  # (...) nu' S^-1 nu over their number; one on the average


def begin(belief: Gaussian, nodes: int) -> LiteralTrack:
    """A track that begins with a belief (..., 4), about N nodes."""
    shape = belief.m.shape[:-1]
    since = np.full(shape, -1, dtype=np.int64)
    return LiteralTrack(belief, recent.nothing(shape, nodes), np.zeros((*belief.m.shape, nodes)), since)


def predict(track: LiteralTrack, dt: float, config: HybridConfig) -> LiteralTrack:
    """Time update by dt [s]."""
    if dt <= 0.0:
        return track
    F, chol_Q = forgetful_velocity(config.motion.spectral_density, dt, config.motion.velocity_time)
    m, P = track.belief
    moved = Gaussian((F @ m[..., None])[..., 0], F @ P @ F.T + chol_Q @ chol_Q.T)
    return track._replace(belief=moved)


def hear(
    track: LiteralTrack, z: Floats, std: Floats, share: Floats, t: float, places: Floats, config: HybridConfig
) -> tuple[LiteralTrack, Heard]:
    """Measurement update of a predicted track with ranges z (..., N) of one instant t [s]; NaN: not heard."""
    told = _listen(track.recent, z, np.sqrt(np.square(std) + np.square(share * z)), t, places, config)
    seen = frozen_gain.linearised(track.belief, z, places, std, share)
    whole, each = frozen_gain.squared(track.belief, seen)
    count = np.maximum(seen.heard.sum(axis=-1), 1)
    rested = (track.since < 0) | (track.since * count >= config.manoeuvre.rest)
    lasted = t - told.since >= config.manoeuvre.fresh * config.period * (1.0 - 1e-9)
    beyond = whole * SUMMED / count > config.manoeuvre.threshold
    turned = beyond & lasted & rested & ~np.isnan(told.raw[..., 0])
    since = np.where(turned, 0, np.where(track.since >= 0, track.since + 1, -1))
    limits = config.manoeuvre.position_std, config.manoeuvre.velocity_std
    fresh = np.where(turned[..., None], told.x, track.belief.m)
    P_z = manoeuvre.error_covariance(track.belief.m, fresh, *limits)
    K_z = np.where(turned[..., None, None], frozen_gain.gain(P_z, seen), track.K_z)
    fading = np.where(since >= 0, config.manoeuvre.decay ** np.maximum(since, 0), 0.0)
    gated = seen.heard & (each > (config.robust.gate or np.inf) ** 2) & (fading < FADED)[..., None]
    kept = frozen_gain.without(seen, gated)
    belief = frozen_gain.update(track.belief, kept, fading[..., None, None] * K_z)
    fit = frozen_gain.squared(track.belief, kept)[0] / np.maximum(kept.heard.sum(axis=-1), 1)
    return LiteralTrack(belief, told, K_z, since), Heard(kept.heard, gated, turned, np.asarray(fit))


def _listen(told: Recent, z: Floats, std: Floats, t: float, places: Floats, config: HybridConfig) -> Recent:
    """Least squares of this instant alone, low-passed; ranges that contradict each other give none."""
    d = np.sqrt(np.maximum(np.square(z) - np.square(places[:, 2]), 0.0))  # in the plane
    heard = ~np.isnan(d)
    told = told._replace(d=d, t=np.where(heard, t, -np.inf), weights=np.where(heard, 1.0, np.nan))
    raw = recent.solve(told, places[:, :2], t, 0.0)
    off = recent.misfit(told, places[:, :2], raw, t, 0.0, 0.0)
    widest = np.max(np.where(heard, std, 0.0), axis=-1)
    with np.errstate(invalid='ignore'):
        raw = np.where((off > config.start.misfit * widest)[..., None], np.nan, raw)
    return recent.follow(told, raw, t, config.least_squares.age_max * config.period, config.least_squares.weight)

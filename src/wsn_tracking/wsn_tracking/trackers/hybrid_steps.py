"""System D range by range (seed 001, section 2), over any leading axes: what the tracker and the studies run."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from wsn_tracking.filters import imm, manoeuvre, recent
from wsn_tracking.filters.ekf import Gaussian, Innovation, spread
from wsn_tracking.filters.ekf import gain as own_gain
from wsn_tracking.filters.ekf import update as ekf_update
from wsn_tracking.filters.imm import Models
from wsn_tracking.filters.manoeuvre import Watch
from wsn_tracking.filters.recent import Recent
from wsn_tracking.models.anchors import Floats, Mask
from wsn_tracking.models.motion import forgetful_velocity
from wsn_tracking.trackers.hybrid_config import HybridConfig
from wsn_tracking.trackers.hybrid_listening import Reading, Rows, is_fresh, listen


class Track(NamedTuple):
    """All that is kept of targets; forms without models have one (J = 1)."""

    models: Models
    recent: Recent
    watch: Watch
    P_z: Floats  # (..., 4, 4) of the last manoeuvre
    since: Rows  # (...) ranges since then; -1: there was none

    @property
    def belief(self) -> Gaussian:
        """Mean and covariance."""
        return imm.merged(self.models) if self.models.mu.shape[-1] > 1 else _only(self.models)


class Outcome(NamedTuple):
    """What became of a range."""

    accepted: Mask
    gated: Mask
    manoeuvre: Mask
    squared: Floats  # nu^2 / S under the model that fits best; one on the average


def begin(belief: Gaussian, nodes: int, config: HybridConfig) -> Track:
    """A track that begins with a belief (..., 4), about N nodes."""
    shape = belief.m.shape[:-1]
    mu = np.array([0.5, 0.5]) if config.form == 'imm' else np.ones(1)
    return Track(
        imm.of(belief, mu),
        recent.nothing(shape, nodes),
        manoeuvre.calm(shape, config.manoeuvre.length),
        np.zeros((*shape, 4, 4)),
        np.full(shape, -1, dtype=np.int64),
    )


def restarted(track: Track, where: Mask, belief: Gaussian, config: HybridConfig) -> Track:
    """The tracks begun anew with a belief (..., 4) where it is said."""
    fresh = begin(belief, track.recent.d.shape[-1], config)

    def chosen(new: Any, old: Any) -> Any:
        if isinstance(new, tuple):
            return type(new)._make(chosen(n, o) for n, o in zip(new, old, strict=True))  # type: ignore[attr-defined]
        return np.where(where[(..., *(None,) * (new.ndim - where.ndim))], new, old)

    return chosen(fresh, track)._replace(recent=track.recent)  # type: ignore[no-any-return]


def predict(track: Track, dt: float, config: HybridConfig) -> Track:
    """Time update by dt [s]."""
    if dt <= 0.0:
        return track
    models = track.models
    if config.form == 'imm':
        chain = (config.models.stay_calm, config.models.stay_brisk)
        models = imm.mix(models, imm.transition(chain, dt / config.period))
        S = config.models.spectral_density * np.array([config.models.calm, config.models.brisk])
    else:
        S = np.array([config.motion.spectral_density])
    F, chol_Q = forgetful_velocity(S, dt, config.motion.velocity_time)
    P = F @ models.P @ np.swapaxes(F, -1, -2) + chol_Q @ np.swapaxes(chol_Q, -1, -2)
    return track._replace(models=Models((F @ models.m[..., None])[..., 0], P, models.mu))


def innovation(track: Track, reading: Reading, places: Floats) -> Innovation:
    """Under each model, (..., J)."""
    return imm.innovation(track.models, reading.z, places[reading.rows], reading.std, reading.share)


def hear(track: Track, reading: Reading, t: float, places: Floats, config: HybridConfig) -> tuple[Track, Outcome]:
    """Measurement update of a predicted track with one range at t [s] (any clock that all steps share)."""
    heard = ~np.isnan(reading.z)
    seen = innovation(track, reading, places)
    turned = np.zeros_like(heard)
    if config.form not in ('imm', 'ekf'):
        credible = _credible(reading.z, seen, config)
        told = listen(track.recent, reading._replace(z=credible), t, places, config)
        watched = _first(seen)._replace(nu=np.where(np.isnan(credible), np.nan, seen.nu[..., 0]))
        watch, beyond = manoeuvre.observe(track.watch, watched, config.manoeuvre.threshold)
        turned = beyond & is_fresh(told, t, places, config) if beyond.any() else turned
        track = track._replace(recent=told, watch=manoeuvre.answered(watch, turned, config.manoeuvre.rest))
        track = _answer(track, heard, turned, config)
        seen = innovation(track, reading, places) if turned.any() else seen
    gated = heard & _beyond(track, seen, config)
    outcome = Outcome(heard & ~gated, gated, turned, seen.squared.min(axis=-1))
    seen = seen._replace(nu=np.where(gated[..., None], np.nan, seen.nu))
    return _update(track, seen, config), outcome


def heavy_tailed(seen: Innovation, dof: float) -> Innovation:
    """R grown as a Student-t channel takes the residual: R (dof + nu^2 / S) / (dof + 1), never below R."""
    if not dof:
        return seen
    factor = np.where(np.isnan(seen.nu), 1.0, np.maximum((dof + seen.squared) / (dof + 1.0), 1.0))
    return seen._replace(R=seen.R * factor, S=seen.S + seen.R * (factor - 1.0))


def _beyond(track: Track, seen: Innovation, config: HybridConfig) -> Mask:
    """Whether a range is too far off under every model."""
    if not config.robust.gate:
        return np.zeros(seen.nu.shape[:-1], dtype=np.bool_)
    S = seen.S
    if config.form == 'decay':
        S = S + (_fading(track, config) * spread(track.P_z, seen.g[..., 0, :]))[..., None]
    with np.errstate(invalid='ignore'):
        return np.asarray((np.square(seen.nu) > config.robust.gate**2 * S).all(axis=-1))


def _credible(z: Floats, seen: Innovation, config: HybridConfig) -> Floats:
    """Ranges that the target may have caused, whatever it did in the last few periods; NaN for others."""
    if not config.robust.gate:
        return z
    way = config.start.velocity_std * config.manoeuvre.fresh * config.period
    off = np.abs(_first(seen).nu) - config.robust.gate * np.sqrt(_first(seen).S)
    with np.errstate(invalid='ignore'):
        return np.where(off > way, np.nan, z)


def _fading(track: Track, config: HybridConfig) -> Floats:
    """lambda^(k - k0), counted in ranges; zero where there was no manoeuvre."""
    return np.where(track.since >= 0, config.manoeuvre.decay ** np.maximum(track.since, 0), 0.0)


def _answer(track: Track, heard: Mask, turned: Mask, config: HybridConfig) -> Track:
    """What a manoeuvre changes."""
    since = np.where(turned, 0, np.where(track.since >= 0, track.since + heard, -1))
    if not turned.any():
        return track._replace(since=since)
    limits = config.manoeuvre.position_std, config.manoeuvre.velocity_std
    belief = track.belief
    P_z = manoeuvre.error_covariance(belief.m, track.recent.x, *limits)
    there = turned[..., None, None]
    if config.form == 'inflate':
        models = imm.of(Gaussian(belief.m, np.where(there, belief.P + P_z, belief.P)), np.ones(1))
        return track._replace(models=models)
    return track._replace(P_z=np.where(there, P_z, track.P_z), since=since)


def _update(track: Track, seen: Innovation, config: HybridConfig) -> Track:
    seen = heavy_tailed(seen, config.robust.dof)
    if config.form == 'imm':
        return track._replace(models=imm.update(track.models, seen))
    belief, seen = track.belief, _first(seen)
    K = own_gain(belief.P, seen.g, seen.R)
    if config.form == 'decay':
        K_z = manoeuvre.extra_gain(track.P_z, seen)
        K = manoeuvre.with_extra(K, _fading(track, config)[..., None] * K_z, seen.g)
    return track._replace(models=imm.of(ekf_update(belief, seen, K), np.ones(1)))


def _only(models: Models) -> Gaussian:
    return Gaussian(models.m[..., 0, :], models.P[..., 0, :, :])


def _first(seen: Innovation) -> Innovation:
    return Innovation(seen.nu[..., 0], seen.g[..., 0, :], seen.S[..., 0], seen.R[..., 0])

"""Particle filter: weighted particles, their update in the log domain, moments and resampling (seed 003, section 3).

States are the rows and particles the columns, so that each state of all particles is contiguous; leading axes are runs.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wsn_tracking.filters.linalg import every, identity, some, transpose
from wsn_tracking.filters.resampling import Indices, Resampler
from wsn_tracking.models.anchors import Floats, Mask


class Cloud(NamedTuple):
    """Weighted particles."""

    s: Floats  # (..., S, P) states
    log_w: Floats  # (..., P), their exponentials sum to one
    exp_log_w: Floats | None = None  # these exponentials, where they are at hand

    @property
    def w(self) -> Floats:
        """Weights (..., P)."""
        return np.exp(self.log_w) if self.exp_log_w is None else self.exp_log_w


class Resampled(NamedTuple):
    """Particles after a resampling, and where they came from."""

    cloud: Cloud
    parents: Indices | None  # (..., P) in the cloud before; None: nothing was resampled


def equal(s: Floats) -> Cloud:
    """Particles s (..., S, P) of equal weight."""
    P = s.shape[-1]
    return Cloud(s, np.full((*s.shape[:-2], P), -np.log(P)))


def log_sum(l: Floats) -> Floats:
    """log sum exp over the last axis, (..., P) -> (...); -inf where every term is."""
    top = l.max(axis=-1)
    known = np.isfinite(top)
    if every(known):
        return np.asarray(np.log(np.exp(l - top[..., None]).sum(axis=-1)) + top)
    total = np.exp(l - np.where(known, top, 0.0)[..., None]).sum(axis=-1)
    return np.asarray(np.where(known, np.log(np.maximum(total, 1.0)) + top, top))


def reweighed(cloud: Cloud, l: Floats) -> tuple[Cloud, Floats]:
    """The particles after an observation with log-likelihood l (..., P), and its log evidence (...).

    log p(z_t | z_1:t-1) = log sum exp(log w + l) (seed 003, eq. 7 and 8). An observation that no particle can explain
    (evidence -inf) leaves the weights as they are.
    """
    joint = cloud.log_w + l
    top = joint.max(axis=-1)
    if every(np.isfinite(top)):
        w = np.exp(joint - top[..., None])
        total = w.sum(axis=-1)
        evidence = np.asarray(np.log(total) + top)
        return Cloud(cloud.s, joint - evidence[..., None], w / total[..., None]), evidence
    evidence = log_sum(joint)
    known = np.isfinite(evidence)
    log_w = np.where(known[..., None], joint - np.where(known, evidence, 0.0)[..., None], cloud.log_w)
    return Cloud(cloud.s, log_w), evidence


def moments(values: Floats, w: Floats, floor: float = 0.0) -> tuple[Floats, Floats]:
    """Mean (..., K) and covariance (..., K, K) of values (..., K, P) with weights (..., P).

    floor^2 is added to the variances: what a cloud that has collapsed is not sure of all the same.
    """
    mean = (values @ w[..., None])[..., 0]
    d = values - mean[..., None]
    P = (d * w[..., None, :]) @ transpose(d)
    P += transpose(P)
    P *= 0.5
    P += floor**2 * identity(P.shape[-1])
    return mean, P


def resampled(
    cloud: Cloud,
    resampler: Resampler,
    generator: np.random.Generator,
    wanted: Mask | bool = True,
    n: int = 0,
    w: Floats | None = None,
) -> Resampled:
    """n equal particles (0: as many as there are) where `wanted` (...), the cloud as it is elsewhere.

    A number that differs must be wanted by all. w: the weights, where they are at hand.
    """
    P, wanted = cloud.log_w.shape[-1], np.asarray(wanted)
    if not some(wanted):
        return Resampled(cloud, None)
    parents = resampler(cloud.w if w is None else w, n or P, generator)
    if every(wanted):
        return Resampled(equal(taken(cloud.s, parents)), parents)
    parents = np.where(wanted[..., None], parents, np.arange(P))
    log_w = np.where(wanted[..., None], -np.log(P), cloud.log_w)
    return Resampled(Cloud(taken(cloud.s, parents), log_w), parents)


def taken(s: Floats, parents: Indices) -> Floats:
    """States (..., S, P) of the particles with these indices (..., n)."""
    if parents.ndim == 1:
        return s.take(parents, axis=-1)
    return np.take_along_axis(s, parents[..., None, :], axis=-1)


def descended(parents: Indices | None, path: Indices | None) -> Indices | None:
    """Parents of the parents: indices one generation further back; None is everybody's own successor."""
    if parents is None or path is None:
        return parents if path is None else path
    return np.take_along_axis(parents, path, axis=-1)


def worth(w: Floats) -> Floats:
    """N_eff = 1 / sum w^2 (...): how many equal particles the weights (..., P) are worth (seed 003, step 4)."""
    return np.asarray(1.0 / np.einsum('...p,...p->...', w, w))

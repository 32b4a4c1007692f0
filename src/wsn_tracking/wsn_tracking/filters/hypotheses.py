"""Where a target may be while ranges alone leave several places: a mixture of Gaussians, each an EKF of second order.

Two circles cut twice, and one leaves a ring. Each hypothesis follows one place; likelihoods tell which is left. A
hypothesis that is wide against its distance to a node is split before that node's range bends it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wsn_tracking.filters import ekf
from wsn_tracking.filters.ekf import Gaussian
from wsn_tracking.models.anchors import Floats

Box = tuple[float, float, float, float]  # x_min, y_min, x_max, y_max [m]
BEND = 0.3  # a hypothesis wider than this share of its distance is split: the circle bends within it
SPLIT_AT, SPLIT_W = 1.0575, (0.2252, 0.5496, 0.2252)  # N(0, 1) as three, all but equal to it
SPLIT_VARIANCE = 1.0 - 2.0 * SPLIT_W[0] * SPLIT_AT**2  # of each: together they have that of the one
ROUNDS = 6  # of splitting
FAINT = 1e-4  # hypotheses below this share of the best are dropped
NEAR = 1.0  # those closer than this, in their own deviations, are one
SPACING = 0.6  # [deviations of the ring along itself] between its hypotheses
FLAT = 1e-12  # a place is at least this much as wide, in variance, as it is long: rounding may have left it a line


class Hypotheses(NamedTuple):
    """A mixture of H places."""

    m: Floats  # (H, n)
    P: Floats  # (H, n, n)
    w: Floats  # (H,) weights, summing to one


def one(belief: Gaussian) -> Hypotheses:
    """A single place."""
    return Hypotheses(belief.m[None], belief.P[None], np.ones(1))


def ring(place: Floats, d: float, std: float, area: Box, velocity_std: float, most: int) -> Hypotheses:
    """All places at distance d [m] in the plane from a node at place (2,), inside an area, at rest on the average.

    No place inside: all of them.
    """
    count = int(np.clip(2.0 * np.pi * d / 0.5, 8, most))
    angle = 2.0 * np.pi * np.arange(count) / count
    u = np.column_stack([np.cos(angle), np.sin(angle)])
    x = place + d * u
    inside = np.all((x >= area[:2]) & (x <= area[2:]), axis=-1)
    u, x = (u[inside], x[inside]) if inside.any() else (u, x)
    along = max(2.0 * np.pi * d / count * SPACING, std)
    across = np.stack([-u[:, 1], u[:, 0]], axis=-1)
    P = np.zeros((len(x), 4, 4))
    P[:, :2, :2] = std**2 * u[:, :, None] * u[:, None, :] + along**2 * across[:, :, None] * across[:, None, :]
    P[:, range(2, 4), range(2, 4)] = velocity_std**2
    return Hypotheses(np.concatenate([x, np.zeros_like(x)], axis=-1), P, np.full(len(x), 1.0 / len(x)))


def predict(places: Hypotheses, F: Floats, Q: Floats) -> Hypotheses:
    """Time update of all."""
    return Hypotheses(*ekf.predict(Gaussian(places.m, places.P), F, Q), places.w)


def update(
    places: Hypotheses, z: float, place: Floats, std: float, share: float, dof: float
) -> tuple[Hypotheses, float]:
    """Measurement update with one range of a node at place (3,), and the logarithm of how well it was foreseen.

    The second derivative (I - g g') / d moves the expected range and adds to its variance, so that a wide hypothesis
    does not take its tangent for the circle. `dof`: of Student-t noise, 0: Gaussian.
    """
    for _ in range(ROUNDS):
        places, done = split(places, z, place)
        if done:
            break
    belief = Gaussian(places.m, places.P)
    seen = ekf.innovation(belief, z, place, std, share)
    bent = (np.eye(2) - seen.g[:, :, None] * seen.g[:, None, :]) / (z - seen.nu)[:, None, None]
    BP = bent @ places.P[:, :2, :2]
    extra = 0.5 * np.trace(BP @ BP, axis1=-2, axis2=-1)
    nu = seen.nu - 0.5 * np.trace(BP, axis1=-2, axis2=-1)
    R, S = seen.R + extra, seen.S + extra
    if dof:
        log_l = -0.5 * (dof + 1.0) * np.log1p(nu * nu / (dof * S)) - 0.5 * np.log(2.0 * np.pi * S)
        grown = R * np.maximum((dof + nu * nu / S) / (dof + 1.0), 1.0)
        R, S = grown, S + grown - R
    else:
        log_l = -0.5 * (nu * nu / S + np.log(2.0 * np.pi * S))
    m, P = ekf.update(belief, ekf.Innovation(nu, seen.g, S, R))
    best = float(log_l.max())
    w = places.w * np.exp(log_l - best)
    return Hypotheses(m, P, w / w.sum()), best + float(np.log(w.sum()))


def split(places: Hypotheses, z: float, place: Floats) -> tuple[Hypotheses, bool]:
    """Those too wide for the bend of the circle as three each, along their longest axis; and whether none was."""
    values, axes = np.linalg.eigh(places.P[:, :2, :2])
    offset = np.sqrt(np.sum(np.square(places.m[:, :2] - place[:2]), axis=-1))
    wide = (np.sqrt(values[:, 1]) > BEND * np.maximum(offset, z)) & (places.w > FAINT)
    if not wide.any():
        return places, True
    m, P, w = places.m[wide], places.P[wide], places.w[wide]
    c = (P[:, :, :2] @ axes[wide][:, :, 1, None])[..., 0] / np.sqrt(values[wide, 1])[:, None]
    narrow = P - (1.0 - SPLIT_VARIANCE) * c[:, :, None] * c[:, None, :]
    kept = ~wide
    return Hypotheses(
        np.concatenate([places.m[kept], *(m + at * c for at in (-SPLIT_AT, 0.0, SPLIT_AT))]),
        np.concatenate([places.P[kept], narrow, narrow, narrow]),
        np.concatenate([places.w[kept], *(share * w for share in SPLIT_W)]),
    ), False


def reduced(places: Hypotheses, most: int) -> Hypotheses:
    """Without faint ones, with close ones merged, and at most so many."""
    order = np.argsort(-places.w, kind='stable')[: 4 * most]
    order = order[places.w[order] >= FAINT * places.w[order[0]]]
    m, P, w = places.m[order], places.P[order], places.w[order]
    out: list[tuple[Floats, Floats, float]] = []
    left = np.ones(len(w), dtype=np.bool_)
    for i in range(len(w)):
        if not left[i] or len(out) == most:
            continue
        e, P_i = m[:, :2] - m[i, :2], P[i, :2, :2]
        near = left & (np.sum(e * np.linalg.solve(P_i + FLAT * np.trace(P_i) * np.eye(2), e.T).T, axis=-1) < NEAR**2)
        near[i] = True
        left &= ~near
        merged = moments(Hypotheses(m[near], P[near], w[near] / w[near].sum()))
        out.append((merged.m, merged.P, float(w[near].sum())))
    columns = [np.stack(column) for column in zip(*out, strict=True)]
    return Hypotheses(columns[0], columns[1], columns[2] / columns[2].sum())


def kept_inside(places: Hypotheses, area: Box, fade: float) -> Hypotheses:
    """Those beyond an area lose weight, by a Gaussian of `fade` [m] of how far they are."""
    x = places.m[:, :2]
    off = np.maximum(np.maximum(area[:2] - x, x - area[2:]), 0.0).sum(axis=-1)
    w = places.w * np.maximum(np.exp(-0.5 * np.square(off / fade)), 1e-300)
    return places._replace(w=w / w.sum())


def together(first: Hypotheses, second: Hypotheses, share: float) -> Hypotheses:
    """Either of two mixtures, the second with a probability."""
    return Hypotheses(
        np.concatenate([first.m, second.m]),
        np.concatenate([first.P, second.P]),
        np.concatenate([(1.0 - share) * first.w, share * second.w]),
    )


def moments(places: Hypotheses) -> Gaussian:
    """Mean and covariance of the mixture."""
    mean = places.w @ places.m
    e = places.m - mean
    return Gaussian(mean, np.einsum('h,hij->ij', places.w, places.P + e[:, :, None] * e[:, None, :]))

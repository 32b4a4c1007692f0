"""What a person's body does to the signal strengths of a node that is worn, from a walk whose headings are known.

Beside a node's own path loss, readings of nodes in front of the body lie on one line over lg d, those of nodes behind
it on another (seed 003, eq. 3 and 4), all nodes alike; where nobody knows where the body faces, there is one constant.
Lines are Huber's, slopes loosely held at 0; standard deviations come from leaving out a tenth of the walk at a time,
since readings of one moment and place err together.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import Anchors, Floats, Mask
from wsn_tracking.models.body import LEAST_DISTANCE, is_behind, single_of
from wsn_tracking.sensing.channel import Body, Channel, Quantity, apply
from wsn_tracking.sensing.channel_fit import fit_path_loss
from wsn_tracking.sensing.robust_fit import GAUSSIAN, HUBER, LEAST, PASSES
from wsn_tracking.sensing.survey import Readings, survey_of

SLOPE_STD = 5.0  # [dB per decade] what is known of a slope beside path loss before any reading
PARTS = 10  # of the walk, of which one at a time is left out
WIDTH = 1.96  # standard deviations of a 95 % interval
LEAST_READINGS = 20  # of each side
TURNS = 3  # path loss, then body
ON_THE_WAY = 0.1  # [m/s] who is slower stands, and faces where he did


class Worn(NamedTuple):
    """Readings of a worn node, in the order of time."""

    lg_d: Floats  # (M,) lg of the distance [m]
    away: Floats  # (M,) [dB] signal strength minus the node's own path loss
    behind: Floats  # (M,) 1: the body is between; 0: it is not; NaN: nobody knows


def behind_body(anchors: Anchors, readings: Readings, facing: Floats) -> Floats:
    """Whether the body is between (M,): 1, 0, or NaN where nobody knows where it faces (M,) [rad] (eq. 12 and 13)."""
    towards = anchors.positions[anchors.rows(readings.node_ids), :2] - readings.positions[:, :2]
    between = is_behind(towards[:, None], facing)[:, 0]
    return np.where(np.isfinite(facing), between, math.nan)


def known_alone(anchors: Anchors, readings: Readings, facing: Floats) -> tuple[Readings, Floats]:
    """The readings of nodes that are among the anchors."""
    use = anchors.rows(readings.node_ids) >= 0
    return Readings(readings.positions[use], readings.node_ids[use], readings.values[use]), facing[use]


def worn_of(anchors: Anchors, readings: Readings, behind: Floats) -> Worn:
    """Readings beside the path loss of their nodes, which are among the anchors."""
    rows = anchors.rows(readings.node_ids)
    d = np.maximum(np.linalg.norm(readings.positions - anchors.positions[rows], axis=1), LEAST_DISTANCE)
    lg_d = np.log10(d)
    own = single_of(anchors)
    return Worn(lg_d, readings.values - own.p_ref[rows] - own.k[rows] * lg_d, behind)


def without_body(readings: Readings, worn: Worn, body: Body) -> Readings:
    """The readings with half of what lies between both lines taken off each side: what path loss is fitted to."""
    if body.los is None or body.nlos is None:
        return readings
    half = 0.5 * (_at(body.los, worn.lg_d) - _at(body.nlos, worn.lg_d))
    known = np.isfinite(worn.behind)
    return readings._replace(
        values=readings.values - np.where(known, 1.0 - 2.0 * np.nan_to_num(worn.behind), 0.0) * half
    )


def fit_body(worn: Worn) -> Body:
    """The lines beside path loss; one constant alone where fewer than LEAST_READINGS are known to be of a side.

    Raises TrackingError for fewer readings than that in all.
    """
    M = worn.away.size
    if M < LEAST_READINGS:
        raise TrackingError(f'{M} readings tell nothing of a body: at least {LEAST_READINGS} of a walk are expected')
    front, back = worn.behind == 0.0, worn.behind == 1.0
    part = np.arange(M) * PARTS // M
    loss = _told(worn, np.full(M, fill_value=True), part, _level)
    if min(front.sum(), back.sum()) < LEAST_READINGS:
        return Body(loss, None, None, _scatter(worn.away - loss.value[0]), (M, 0))
    los, nlos = _told(worn, front, part, _line), _told(worn, back, part, _line)
    rest = np.concatenate([worn.away[side] - _at(line, worn.lg_d[side]) for side, line in ((front, los), (back, nlos))])
    return Body(loss, los, nlos, _scatter(rest), (int(front.sum()), int(back.sum())))


def _at(line: Quantity, lg_d: Floats) -> Floats:
    return np.asarray(line.value[0] + line.value[1] * lg_d)


def _told(worn: Worn, use: Mask, part: NDArray[np.int64], fit: Callable[[Floats, Floats], Floats]) -> Quantity:
    """The numbers of a fit with their jackknife standard deviations."""
    value = fit(worn.lg_d[use], worn.away[use])
    others = [use & (part != i) for i in range(PARTS) if np.any(use & (part == i))]
    told = np.stack([fit(worn.lg_d[some], worn.away[some]) for some in others]) if len(others) > 1 else value[None]
    std = np.sqrt((len(told) - 1) / len(told) * np.sum((told - told.mean(axis=0)) ** 2, axis=0))
    return Quantity(value, std, value - WIDTH * std, value + WIDTH * std)


def _level(_lg_d: Floats, y: Floats) -> Floats:
    """A constant, (1,)."""
    return _huber(np.ones((y.size, 1)), y, np.zeros(1))


def _line(lg_d: Floats, y: Floats) -> Floats:
    """Value at 1 m and slope, (2,)."""
    return _huber(np.stack([np.ones(y.size), lg_d], axis=-1), y, np.array([0.0, SLOPE_STD**-2]))


def _huber(H: Floats, y: Floats, prior: Floats) -> Floats:
    """Robust least squares of y ~ H beta by iterated weights; prior: precision of each beta about 0."""
    w: Floats = np.ones(y.size)
    beta: Floats = np.zeros(H.shape[1])
    for _ in range(PASSES):
        scale = _scatter(y - H @ beta)
        before = beta
        beta = np.linalg.solve(H.T @ (w[:, None] * H) + scale**2 * np.diag(prior), H.T @ (w * y))
        size = np.abs(y - H @ beta)
        w = np.minimum(1.0, HUBER * scale / np.maximum(size, HUBER * scale))
        if np.allclose(beta, before, rtol=0.0, atol=1e-6):
            break
    return beta


def _scatter(e: Floats) -> float:
    return max(GAUSSIAN * float(np.median(np.abs(e - np.median(e)))), LEAST)


def facing(stamps_ns: NDArray[np.int64], positions: Floats, velocities: Floats, headings: Floats | None) -> Floats:
    """Where a body faces at the stamps (K,) of a track [rad]: as told, else where it walks; NaN: nobody knows.

    Who stands faces where he did. positions and velocities (K, 2 or 3); velocities that are NaN are those of the
    positions.
    """
    v = np.array(velocities[:, :2])
    unknown = ~np.isfinite(v).all(axis=-1)
    if unknown.any() and len(v) > 1:
        t = (stamps_ns - stamps_ns[0]) * 1e-9
        v[unknown] = np.gradient(positions[:, :2], t, axis=0)[unknown]
    with np.errstate(invalid='ignore'):
        walks = np.hypot(v[:, 0], v[:, 1]) > ON_THE_WAY
    last = np.maximum.accumulate(np.where(walks, np.arange(len(v)), -1))
    way = np.where(last >= 0, np.arctan2(v[last, 1], v[last, 0]), math.nan)
    return way if headings is None else np.where(np.isfinite(headings), headings, way)


def fit_worn(readings: Readings, facing: Floats, anchors: Anchors, known: Channel | None = None) -> Channel:
    """A channel with a body, from a walk: beside radios that are `known`, else beside those that the walk itself tells.

    In the latter case path loss is the line in the middle between both sides, as the document's single curve is: it
    is fitted to readings without the half of their difference, in turns with the body.
    """
    readings, facing = known_alone(anchors, readings, facing)
    behind = behind_body(anchors, readings, facing)
    if known is not None:
        if known.path_loss is None:
            raise TrackingError('the channel has no path loss: give that of a survey of signal strengths')
        body = fit_body(worn_of(apply(known, anchors), readings, behind))
        return known._replace(body=body)
    plain = readings
    for _ in range(TURNS):
        loss, _, told = fit_path_loss(survey_of(plain, anchors))
        channel = Channel(anchors.ids, loss, None, None, told)
        worn = worn_of(apply(channel, anchors), readings, behind)
        body = fit_body(worn)
        plain = without_body(readings, worn, body)
    return channel._replace(body=body)

"""What a person's body does to signal strengths: two curves, and by which a node is heard (seed 003, section 2).

The person wears the node on the chest. A node in front of him is in line of sight, one behind him is not.
The document prints the names of the two curves the wrong way round: here LOS is the stronger one.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from wsn_tracking.models.anchors import Anchors, Floats, Mask

LEAST_DISTANCE = 0.3  # [m] the chest is not nearer to a node


class Curve(NamedTuple):
    """P(d) = p_ref + k lg d (seed 003, eq. 1 to 4); both may be of shape (N,), one curve a node."""

    p_ref: Any  # [dBm] at 1 m
    k: Any  # [dB] per decade, negative


LOS = Curve(-45.27, -21.95)
NLOS = Curve(-52.92, -25.77)
SINGLE = Curve(-49.28, -23.95)  # one curve for both, in the middle
SINGLE_PRINTED = Curve(-45.27, -23.95)  # its P_ref in the document is that of another curve


class Curves(NamedTuple):
    """The channel of each node (N,) with a body beside it."""

    los: Curve
    nlos: Curve
    single: Curve


def mean_rssi(curve: Curve, d: Floats, least: float = LEAST_DISTANCE) -> Floats:
    """Mean signal strength (..., N) [dBm] at distances (..., N) [m]."""
    return np.asarray(curve.p_ref + curve.k * np.log10(np.maximum(d, least)))


def single_of(anchors: Anchors) -> Curve:
    """Each node's own path loss, (N,)."""
    return Curve(anchors.p1_dbm + 10.0 * anchors.n * np.log10(anchors.d0), -10.0 * anchors.n)


def shifted(curve: Curve, base: Curve, about: Curve) -> Curve:
    """A curve as far from `about` as it is from `base`."""
    return Curve(curve.p_ref - base.p_ref + about.p_ref, curve.k - base.k + about.k)


def about_anchors(curves: Curves, anchors: Anchors) -> Curves:
    """The same body beside other radios: LOS and NLOS lie about each node's own path loss as about `single`."""
    own = single_of(anchors)
    return Curves(shifted(curves.los, curves.single, own), shifted(curves.nlos, curves.single, own), own)


def is_behind(towards: Floats, facing: Floats) -> Mask:
    """o_i: whether the body is between him and a node (seed 003, eq. 12 and 13): (A_i - x) . u(psi) <= 0.

    towards (..., N, 2) from the person to each node; facing (...) the direction psi of his chest [rad].
    """
    u = np.stack([np.cos(facing), np.sin(facing)], axis=-1)[..., None, :]
    return np.asarray(np.sum(towards * u, axis=-1) <= 0.0)

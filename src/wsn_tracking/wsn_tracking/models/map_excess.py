"""What nodes should read at particles beyond path loss, as a radio map tells it."""

from __future__ import annotations

import numpy as np

from wsn_tracking.models.anchors import Anchors, Floats
from wsn_tracking.models.radio_map import RadioMap, aligned, residual_mean
from wsn_tracking.models.walk import X, Y


def with_map(anchors: Anchors, radio_map: RadioMap) -> tuple[Anchors, RadioMap]:
    """The anchors with the path loss and the scatter beside the map's field, and the map with their columns."""
    own = aligned(radio_map, anchors)
    sigma = np.hypot(own.packet_db, own.place_db)
    return anchors._replace(p1_dbm=own.p1_dbm, d0=np.ones_like(own.p1_dbm), n=own.n, sigma_db=sigma), own


def excess(radio_map: RadioMap, s: Floats) -> Floats:
    """Signal strength minus path loss (..., N, P) [dB] at particles s (..., S, P)."""
    places = np.swapaxes(s[..., X : Y + 1, :], -1, -2)
    return np.swapaxes(residual_mean(radio_map, places), -1, -2)

"""What a calibration found: the radio of each node, how well that is known, and where it came from."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import Anchors, Floats
from wsn_tracking.models.radio_map import RadioMap


class Quantity(NamedTuple):
    """One number a node, (N,) each."""

    value: Floats
    std: Floats
    low: Floats  # lower end of the 95 % confidence interval
    high: Floats


class PathLoss(NamedTuple):
    """A radio reads p1_dbm - 10 n log10(d / 1 m); sigma_db is the standard deviation of one packet about that."""

    p1_dbm: Quantity
    n: Quantity
    sigma_db: Quantity
    places: NDArray[np.int64]  # (N,) at which a node was heard
    readings: NDArray[np.int64]  # (N,); 0: not told


class Ranging(NamedTuple):
    """A ranging radio reads scale d + bias; sigma is the standard deviation of one range about that [m]."""

    bias: Quantity
    scale: Quantity
    sigma: Quantity
    places: NDArray[np.int64]
    readings: NDArray[np.int64]


class Body(NamedTuple):
    """What being worn does to signal strengths, beside each node's path loss."""

    loss: Quantity  # (1,) [dB] of all readings
    los: Quantity | None  # (2,) of nodes in front of the body: [dB] at 1 m, [dB per decade]; None: not known
    nlos: Quantity | None  # (2,) of those behind it
    sigma_db: float  # scatter about these
    readings: tuple[int, int]  # in front (or all), behind


class Channel(NamedTuple):
    """The radios of nodes `ids` (N,), ascending."""

    ids: NDArray[np.int64]
    path_loss: PathLoss | None
    ranging: Ranging | None
    radio_map: RadioMap | None
    origin: Mapping[str, str]  # where it came from, in words
    body: Body | None = None


def apply(channel: Channel, anchors: Anchors) -> Anchors:
    """The anchors with the radio of the channel; nodes that it lacks keep theirs (see `lacking`).

    Raises TrackingError where it has none of the nodes: then it is of another network.
    """
    rows = _rows(channel, anchors)
    there = rows >= 0

    def column(own: Floats, found: Floats) -> Floats:
        return np.where(there, found[rows], own)

    if channel.path_loss is not None:
        loss = channel.path_loss
        anchors = anchors._replace(
            p1_dbm=column(anchors.p1_dbm, loss.p1_dbm.value),
            d0=column(anchors.d0, np.ones(channel.ids.size)),
            n=column(anchors.n, loss.n.value),
            sigma_db=column(anchors.sigma_db, loss.sigma_db.value),
        )
    if channel.ranging is not None:
        anchors = anchors._replace(
            bias=column(anchors.bias, channel.ranging.bias.value),
            scale=column(anchors.scale, channel.ranging.scale.value),
        )
    return anchors


def lacking(channel: Channel, anchors: Anchors) -> tuple[int, ...]:
    """Ids of the anchors that the channel says nothing of."""
    return tuple(anchors.ids[_rows(channel, anchors) < 0].tolist())


def _rows(channel: Channel, anchors: Anchors) -> NDArray[np.int64]:
    place = {node: row for row, node in enumerate(channel.ids.tolist())}
    rows = np.array([place.get(node, -1) for node in anchors.ids.tolist()], dtype=np.int64)
    if np.all(rows < 0):
        raise TrackingError(
            f'the channel is of nodes {channel.ids.tolist()}, none of which is among the anchors '
            f'{anchors.ids.tolist()}: give the calibration of this network'
        )
    return rows

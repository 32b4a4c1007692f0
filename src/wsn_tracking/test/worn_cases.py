"""A walk among radios that are known, and what the worn node reads."""

import numpy as np

from wsn_tracking.models.body import SINGLE
from wsn_tracking.sensing.body_fit import facing
from wsn_tracking.sensing.channel import Channel, PathLoss, Quantity
from wsn_tracking.sensing.survey import Readings
from wsn_tracking.sensing.values import Rssi
from wsn_tracking.simulation.c_body import BodyConfig, body_scenario, nodes
from wsn_tracking.simulation.record import record

ANCHORS = nodes(BodyConfig())
SECOND = 1_000_000_000


def exact(value):
    """The same for each of 16 nodes, with its interval."""
    return Quantity(*(np.full(16, v) for v in (value, 0.1, value - 0.2, value + 0.2)))


KNOWN = Channel(
    ANCHORS.ids,
    PathLoss(exact(SINGLE.p_ref), exact(-SINGLE.k / 10.0), exact(3.0), np.ones(16, int), np.ones(16, int)),
    None,
    None,
    {'survey': 'of a test'},
)


def walked(config=None, seed=1):
    """A recording of a walk among them."""
    return record(body_scenario('c_walk', config or BodyConfig(), seed), seed)


def measured(recording):
    """Readings and headings of a recording whose epochs have the truth's stamps."""
    truth = recording.truth[1]
    heard = [m for m in recording.messages if isinstance(m, Rssi)]
    at = np.searchsorted(truth.stamps_ns, [m.stamp_ns for m in heard])
    way = facing(truth.stamps_ns, truth.positions, truth.velocities, truth.headings)
    ids, values = np.array([m.node_id for m in heard]), np.array([m.rssi_dbm for m in heard])
    return Readings(truth.positions[at], ids, values), way[at]

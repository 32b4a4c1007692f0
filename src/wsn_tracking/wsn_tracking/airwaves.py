"""What the radios of a recording say, for a simulated sink: measurements of an epoch as readings of its nodes."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from wsn_tracking.errors import TrackingError
from wsn_tracking.graphs import open_bag
from wsn_tracking.sensing import trigger
from wsn_tracking.sensing.recording import Recording, of_target
from wsn_tracking.sensing.values import Measurement, Range, RangeBearing, Request, Rssi
from wsn_tracking.simulation.record import record
from wsn_tracking.simulation.scenarios import scenario
from wsn_tracking.zstack.on_board import Judge, Thresholds
from wsn_tracking.zstack.readings import AirEpoch, Reading

NO_DRAW = np.zeros(())


def recording_of(name: str, bag: str, seed: int, target_id: int = -1) -> Recording:
    """The recording of a bag, or, where none is named, of a scenario."""
    if bag:
        return of_target(open_bag(bag)[1], target_id)
    return of_target(record(scenario(name, seed=seed), seed), target_id)


def air_epochs(recording: Recording) -> list[AirEpoch]:
    """The epochs in the order of their requests; TrackingError for what no radio of this protocol says."""
    if recording.entry_level == 'observation':
        raise TrackingError('a sink carries signal strengths and ranges: expected a recording at level rssi or range')
    requests = sorted((m for m in recording.messages if isinstance(m, Request)), key=lambda r: r.stamp_ns)
    by_epoch: dict[tuple[int, int], list[Reading]] = {}
    for message in recording.messages:
        if isinstance(message, (Rssi, Range, RangeBearing)):
            by_epoch.setdefault((message.target_id, message.request_seq), []).extend(_reading(message))
    first = requests[0].stamp_ns if requests else 0
    return [
        AirEpoch((r.stamp_ns - first) * 1e-9, r.target_id, r.seq, tuple(by_epoch.pop((r.target_id, r.seq), ())))
        for r in requests
    ]


def _reading(m: Measurement) -> Iterable[Reading]:
    if isinstance(m, Rssi) and not math.isnan(m.rssi_dbm):
        yield Reading(m.node_id, rssi_dbm=m.rssi_dbm, sigma=m.sigma_db, n_samples=m.n_samples)
    elif isinstance(m, Range) and m.range >= 0.0:
        yield Reading(m.node_id, range_m=m.range, sigma=math.sqrt(m.variance), n_samples=m.n_samples)


def on_board(alpha: float) -> Judge:
    """The document's event trigger as a mote runs it (seed 000, eq. 1 and 2)."""

    def judge(thresholds: Thresholds, yhat: float, y: float) -> tuple[float, bool]:
        step = trigger.event(trigger.EventThresholds(*thresholds, alpha))
        after, verdict = step(np.asarray(yhat), np.asarray(y), NO_DRAW)
        return float(after), int(verdict) == trigger.SENT

    return judge

"""How good a track is where ranges come in bursts: judged at regular instants, not when an estimate happens to come.

A tracker that speaks only when something was heard would be judged by its data alone. Here every instant of a clock
counts at which something was heard lately: the estimate that was there last, moved on at its velocity, against truth.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation.interpolation import Verdict, truth_at
from wsn_tracking.models.anchors import Floats, Mask
from wsn_tracking.sensing.average import usable
from wsn_tracking.sensing.recording import Recording, Truth
from wsn_tracking.sensing.values import Range, RangeBearing, Rssi
from wsn_tracking.trackers.estimate import Estimate

Stamps = NDArray[np.int64]
RATE = 10.0  # [Hz] of the clock
WITHIN_S = 2.0  # an instant counts while the latest measurement is no older
NODES, NODES_WITHIN_S = 3, 8.0  # heard of so many nodes within so many seconds, a lost target can be found
FOUND_WITHIN_S = 10.0  # and so long it may take from then on


class Heard(NamedTuple):
    """When what was heard of a target, ascending in time."""

    stamps_ns: Stamps  # (M,)
    nodes: NDArray[np.int64]  # (M,) ids


class Instants(NamedTuple):
    """Every instant of the clock from the first measurement to the end of the truth."""

    stamps_ns: Stamps  # (K,)
    errors_m: Floats  # (K,) distance to the truth; infinite before the first estimate, NaN without truth
    counts: Mask  # (K,) something was heard lately and the truth is known

    @property
    def median_m(self) -> float:
        """Median error of the instants that count; NaN where there is none."""
        return float(np.median(self.errors_m[self.counts])) if self.counts.any() else float('nan')


def heard_of(recording: Recording, target_id: int) -> Heard:
    """The usable measurements of a target by nodes whose place is known."""
    known = set(recording.anchors.ids.tolist())
    told = sorted(
        (m.stamp_ns, m.node_id)
        for m in recording.messages
        if isinstance(m, (Range, Rssi, RangeBearing))
        and m.target_id == target_id
        and m.node_id in known
        and usable(m)
        and (not isinstance(m, RangeBearing) or m.arrived)
    )
    table = np.array(told, dtype=np.int64).reshape(-1, 2)
    return Heard(table[:, 0], table[:, 1])


def at_instants(
    estimates: Sequence[Estimate], truth: Truth, heard: Heard, rate: float = RATE, within_s: float = WITHIN_S
) -> Instants:
    """Errors of one output at `rate` [Hz].

    An instant belongs to the latest estimate that is not after it, whatever its kind: who has no track yet is judged
    by what it says. States are x, y, vx, vy first.
    """
    if not (heard.stamps_ns.size and truth.stamps_ns.size):
        lacks = 'truth' if heard.stamps_ns.size else 'measurement'
        raise TrackingError(f'there is no {lacks} of target {truth.target_id}: there is nothing to judge')
    first, last = int(heard.stamps_ns[0]), int(truth.stamps_ns[-1])
    stamps = first + np.round(np.arange(0.0, (last - first) * 1e-9 * rate + 1e-9) / rate * 1e9).astype(np.int64)
    latest = heard.stamps_ns[np.searchsorted(heard.stamps_ns, stamps, side='right') - 1]
    real = truth_at(truth, stamps)
    lately = stamps - latest <= round(within_s * 1e9)
    errors = np.hypot(*(_moved_on(estimates, stamps) - real.positions[:, :2]).T)
    known = real.verdicts == Verdict.SCORED
    errors = np.where(known & np.isnan(errors), np.inf, errors)
    return Instants(stamps, errors, lately & known)


def _moved_on(estimates: Sequence[Estimate], stamps: Stamps) -> Floats:
    """Positions (K, 2) [m] at stamps (K,): of the latest estimate, moved on at its velocity; NaN before the first."""
    ordered = sorted(estimates, key=lambda estimate: estimate.stamp_ns)
    said = np.array([estimate.stamp_ns for estimate in ordered], dtype=np.int64)
    means = np.array([estimate.mean[:4] for estimate in ordered], dtype=np.float64).reshape(-1, 4)
    row = np.searchsorted(said, stamps, side='right') - 1
    if not said.size:
        return np.full((stamps.size, 2), np.nan)
    x, dt = means[np.maximum(row, 0)], (stamps - said[np.maximum(row, 0)]) * 1e-9
    return np.where(row[:, None] >= 0, x[:, :2] + dt[:, None] * x[:, 2:], np.nan)


class Found(NamedTuple):
    """How a track came back, once it could: E times, each with the clock's instants from then on."""

    stamps_ns: Stamps  # (E,) when enough nodes had been heard
    errors_m: Floats  # (E, D) at 0, 1 / rate, ... FOUND_WITHIN_S after; NaN where the instant does not count

    def median_after(self, delay_s: float, rate: float = RATE) -> float:
        """Median over the times that it came back of the error at the last instant that counts up to a delay [s]."""
        kept = self.errors_m[:, : round(delay_s * rate) + 1]
        last = [row[~np.isnan(row)][-1] for row in kept if not np.isnan(row).all()]
        return float(np.median(last)) if last else float('nan')


def found_again(
    instants: Instants, heard: Heard, silence_s: float = WITHIN_S, rate: float = RATE, found_s: float = FOUND_WITHIN_S
) -> Found:
    """The errors after each time that a target could be found: at first, and after every silence of `silence_s`.

    It can be found as soon as NODES nodes have been heard within NODES_WITHIN_S, all since the silence; where the
    next silence comes before, it could not.
    """
    events = _could_be_found(heard, silence_s)
    steps = round(found_s * rate) + 1
    errors = np.full((len(events), steps), np.nan)
    for row, stamp in enumerate(events):
        at = int(np.searchsorted(instants.stamps_ns, stamp))
        kept = slice(at, min(at + steps, instants.stamps_ns.size))
        values = np.where(instants.counts[kept], instants.errors_m[kept], np.nan)
        errors[row, : values.size] = values
    return Found(np.array(events, dtype=np.int64), errors)


def _could_be_found(heard: Heard, silence_s: float) -> list[int]:
    events: list[int] = []
    waiting, since, last = True, 0, None
    stamps, nodes = heard.stamps_ns.tolist(), heard.nodes.tolist()
    for k, stamp in enumerate(stamps):
        if last is not None and stamp - last > silence_s * 1e9:
            waiting, since = True, k
        last = stamp
        while stamp - stamps[since] > NODES_WITHIN_S * 1e9:
            since += 1
        if waiting and len(set(nodes[since : k + 1])) >= NODES:
            events.append(stamp)
            waiting = False
    return events

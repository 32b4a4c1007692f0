"""The sensing nodes: signal strengths in, triggered ranges and a report out."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import Anchors
from wsn_tracking.models.draws import Stream
from wsn_tracking.models.radio import range_at, relative_range_std
from wsn_tracking.parameters import param
from wsn_tracking.sensing import trigger
from wsn_tracking.sensing.average import usable
from wsn_tracking.sensing.values import Epoch, Modality, Range, Reason, Rssi, TriggerReport


@dataclass(frozen=True)
class TriggerConfig:
    """When a sensing node sends its range."""

    kind: str = param(
        'event',
        'event: seed 000 eq. 1 and 2; near: eq. 1 alone; always; random: with probability `rate`',
        choices=('event', 'near', 'always', 'random'),
    )
    y_min: float = param(-55.0, 'service radius: weaker signals are not sent', 'dBm', -200.0, 50.0)
    e_min: float = param(0.2, 'event: smaller changes are no news', 'dB', 0.0, 100.0)
    e_max: float = param(0.6, 'event: larger changes are noise', 'dB', 0.0, 200.0)
    alpha: float = param(0.27, 'event: weight of the past in the pre-filter', '', 0.0, 1.0)
    rate: float = param(0.43, 'random: share that is sent', '', 0.0, 1.0)

    def strategy(self) -> trigger.Trigger:
        """The trigger of these parameters."""
        if self.e_max <= self.e_min:
            raise TrackingError(f'`trigger.e_max` {self.e_max:g} dB is not above `trigger.e_min` {self.e_min:g} dB')
        thresholds = trigger.EventThresholds(self.y_min, self.e_min, self.e_max, self.alpha)
        strategies: dict[str, trigger.Trigger] = {
            'event': trigger.event(thresholds),
            'near': trigger.near(self.y_min),
            'always': trigger.always(),
            'random': trigger.random(self.rate),
        }
        return strategies[self.kind]


class Sensed(NamedTuple):
    """What the sensing nodes send in one epoch."""

    ranges: tuple[Range, ...]
    report: TriggerReport


class SensingStage:
    """The sensing nodes `ids` of a table, one trigger state each; one `step` an epoch of signal strengths."""

    def __init__(self, config: TriggerConfig, anchors: Anchors, ids: Iterable[int] = (), seed: int = 0) -> None:
        wanted = tuple(ids)
        self.anchors = anchors.select(wanted) if wanted else anchors
        self._trigger = config.strategy()
        self._nodes = self.anchors.ids.tolist()
        self._share = relative_range_std(self.anchors)
        self._draws = [Stream(seed, node) for node in self._nodes] if config.kind == 'random' else []
        self.reset()

    def reset(self) -> None:
        """Forget the past: as after a start."""
        self._yhat = np.full(self.anchors.ids.size, np.nan)
        self._sent = [0] * self.anchors.ids.size

    def step(self, epoch: Epoch) -> Sensed:
        """Apply the trigger to an epoch's Rssi values and invert what is sent into ranges."""
        heard = {p.node_id: p for p in epoch.measurements if isinstance(p, Rssi)}
        y = np.array([heard[i].rssi_dbm if i in heard and usable(heard[i]) else np.nan for i in self._nodes])
        self._yhat, verdicts = self._trigger(self._yhat, y, self._uniform(epoch.request_seq))
        z = range_at(self.anchors, y)
        ranges, seqs, silent, reasons = [], [], [], []
        columns = (self._nodes, verdicts.tolist(), z.tolist(), (self._share * z).tolist())
        for row, (node, verdict, distance, std) in enumerate(zip(*columns, strict=True)):
            if verdict != trigger.SENT:
                silent.append(node)
                invalid = node in heard and not usable(heard[node])
                reasons.append(int(Reason.INVALID) if invalid else verdict)
                continue
            packet = heard[node]
            scale = 1.0 if math.isnan(packet.sigma_db) else packet.sigma_db / float(self.anchors.sigma_db[row])
            seqs.append(self._sent[row])
            self._sent[row] += 1
            ranges.append(
                Range(
                    epoch.stamp_ns,
                    node,
                    epoch.target_id,
                    seqs[-1],
                    epoch.request_seq,
                    Modality.RSSI,
                    distance,
                    (scale * std) ** 2,
                    packet.rssi_dbm,
                    packet.n_samples,
                )
            )
        report = TriggerReport(
            epoch.stamp_ns,
            epoch.target_id,
            epoch.request_seq,
            tuple(r.node_id for r in ranges),
            tuple(seqs),
            tuple(silent),
            tuple(reasons),
        )
        return Sensed(tuple(ranges), report)

    def _uniform(self, epoch: int) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
        if not self._draws:
            return np.zeros(self.anchors.ids.size)
        return np.array([draws.at(epoch).random() for draws in self._draws])

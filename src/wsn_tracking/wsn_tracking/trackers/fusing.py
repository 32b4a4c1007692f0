"""What an estimator of system A makes of its own and its neighbours' local estimates (seed 000, section 2.2)."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wsn_tracking.errors import TrackingError
from wsn_tracking.fusion import covariance_intersection as ci
from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.region import kept_inside
from wsn_tracking.parameters import param
from wsn_tracking.trackers.estimate import Estimate, Kind

RULES = {'trace': ci.trace, 'optimal': ci.optimal, 'mean': ci.mean, 'ici': ci.ici}


@dataclass(frozen=True)
class FusionConfig:
    """How local estimates are fused."""

    rule: str = param(
        'trace',
        'trace: CI with weights by 1/tr P; optimal: CI with minimal tr P; lci: only states are exchanged; '
        'mean; ici: inverse covariance intersection',
        choices=('trace', 'optimal', 'lci', 'mean', 'ici'),
    )
    feedback: bool = param(False, 'estimators go on from the fused estimate instead of their own')
    lci_a: float = param(0.5, 'lci: weight of the newest deviation', '', 1e-6, 1.0 - 1e-6)
    lci_std: tuple[float, ...] = param(
        (0.1, 0.1, 0.06, 0.06), 'lci: roots of the diagonal of P0: x, y, vx, vy', 'm and m/s', 1e-6
    )

    def checked(self) -> FusionConfig:
        """Itself, or TrackingError where fields contradict each other."""
        if self.feedback and self.rule in ('mean', 'lci'):
            raise TrackingError(
                f'`fusion.feedback` needs a fused covariance, which `fusion.rule` {self.rule} does not know: '
                'choose trace, optimal or ici'
            )
        if len(self.lci_std) != 4:
            raise TrackingError('`fusion.lci_std` takes four numbers: x, y, vx, vy')
        return self


class Fuser:
    """Fuses the local estimates of one epoch, in the order of their estimators' numbers, whatever theirs was."""

    def __init__(self, config: FusionConfig, source: str, area: tuple[float, ...] = ()) -> None:
        self.config = config.checked()
        self.source = source
        self._area = area
        self._P0 = np.diag(np.square(np.array(config.lci_std)))
        self._spread: dict[int, Floats] = {}

    def reset(self) -> None:
        """Forget the past: as after a start."""
        self._spread.clear()

    def step(self, locals_: Sequence[Estimate]) -> Estimate:
        """The fused estimate of one epoch; at least one local estimate of that epoch, one an estimator."""
        ordered = sorted(locals_, key=lambda e: e.contributors)
        m = np.array([e.mean for e in ordered])
        P = np.array([e.covariance for e in ordered])
        fused = self._lci(ordered, m) if self.config.rule == 'lci' else RULES[self.config.rule](m, P)
        mean = np.array(fused.m)
        mean[:2] = kept_inside(mean[:2], self._area)
        first = ordered[0]
        return Estimate(
            first.stamp_ns,
            first.target_id,
            first.request_seq,
            self.source,
            mean,
            fused.P,
            tuple(sorted({i for e in ordered for i in e.contributors})),
            tuple(sorted({i for e in ordered for i in e.measurements})),
            float('nan'),
            Kind.START if all(e.kind == Kind.START for e in ordered) else Kind.FUSED,
            first.state_names,
        )

    def _lci(self, ordered: Sequence[Estimate], m: Floats) -> ci.Fused:
        """Own recursion of every peer's spread; a peer that missed an epoch starts anew at P0."""
        numbers = [e.contributors[0] for e in ordered]
        before = np.array([self._spread.get(i, self._P0) for i in numbers])
        after = ci.spread(before, m, self.config.lci_a)
        self._spread = dict(zip(numbers, after, strict=True))
        return ci.lci(m, after)


def compared(config: FusionConfig) -> tuple[Fuser, Fuser]:
    """The rules that every run is compared with: the plain mean and LCI of the same locals."""
    base = dataclasses.replace(config, feedback=False)
    return (
        Fuser(dataclasses.replace(base, rule='mean'), 'mean'),
        Fuser(dataclasses.replace(base, rule='lci'), 'lci'),
    )

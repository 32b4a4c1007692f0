"""What is kept of the trackers on a set: each track by itself, pooled, and as plain numbers."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from wsn_tracking.evaluation.run import summarise
from wsn_tracking.evaluation.score import Score, pool
from wsn_tracking.offline import offline
from wsn_tracking.parameters import Values
from wsn_tracking.studies.real_radio.sets import Bags

Result = dict[str, Any]
Scores = Sequence[Mapping[str, Score]]  # of each track, by output


def of_tracks(bags: Bags, configuration: str, settings: Values) -> Scores:
    """Each track by itself, from the set's `skip_s` on."""
    runs = [(*bag, offline(*bag, configuration, settings)) for bag in bags.opened]
    return [summarise(source.title, recording, run, bags.skip_s).outputs for source, recording, run in runs]


def pooled(bags: Bags, configuration: str, settings: Values) -> Mapping[str, Score]:
    """All tracks of a set as one, by output."""
    scores = of_tracks(bags, configuration, settings)
    return {output: pool([of_track[output] for of_track in scores]) for output in scores[0]}


def figures(score: Score) -> Result:
    """What is kept of a score."""
    return {
        'rmse_m': short(score.rmse_m),
        'median_m': short(score.median_m),
        'p95_m': short(score.p95_m),
        'nees': short(score.nees),
        'nees_interval_95': [short(end) for end in score.nees_interval],
        'epochs': score.epochs,
    }


def short(value: float) -> float | None:
    """Four digits; None where nothing is known."""
    return float(f'{value:.4g}') if math.isfinite(value) else None

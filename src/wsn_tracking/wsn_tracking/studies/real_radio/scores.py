"""What is kept of the trackers on a set: each track by itself, pooled, and as plain numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from wsn_tracking.evaluation.run import summarise
from wsn_tracking.evaluation.score import Score, pool
from wsn_tracking.offline import offline
from wsn_tracking.parameters import Values
from wsn_tracking.studies.intervals import known
from wsn_tracking.studies.real_radio.sets import Bags
from wsn_tracking.studies.results import Result

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
        'rmse_m': known(score.rmse_m),
        'median_m': known(score.median_m),
        'p95_m': known(score.p95_m),
        'nees': known(score.nees),
        'nees_interval_95': [known(end) for end in score.nees_interval],
        'epochs': score.epochs,
    }

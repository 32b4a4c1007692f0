"""System E on ranges of which ever fewer arrive."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from wsn_tracking.bags.thin import thin
from wsn_tracking.configuration import load_configuration
from wsn_tracking.evaluation.run import epochs_of
from wsn_tracking.evaluation.score import Score, pool, score
from wsn_tracking.models.links import Loss
from wsn_tracking.parameters import Values, build
from wsn_tracking.studies.real_radio.scores import figures
from wsn_tracking.studies.real_radio.sets import Bags, Sets
from wsn_tracking.studies.results import Result
from wsn_tracking.trackers.loss_tolerant import LossTolerantTracker
from wsn_tracking.trackers.loss_tolerant_config import LossTolerantConfig

CONFIGURATION = 'loss_tolerant_lias'
SEEDS = (1, 2, 3, 4, 5)  # of the losses
KINDS = {'rounds': Loss(whole_round=True), 'bursts_of_20': Loss(burst=20.0)}
FILTERS = ('ckf', 'ekf', 'ukf', 'hold')


def scored(bags: Bags, loss: Loss, settings: Values, seeds: tuple[int, ...] = SEEDS) -> Score:
    """The tracker on the first bag of a set, pooled over draws of what is lost."""
    source, recording = bags.opened[0]
    given = {
        'area': list(source.area),
        'target_height': float(source.metadata['target_height']),
        **load_configuration(CONFIGURATION).of('loss_tolerant_tracker'),
        **settings,
    }
    config = build(LossTolerantConfig, given)
    scores = []
    for seed in seeds if loss.rate else seeds[:1]:
        thinned = thin(recording, loss, seed)
        tracker = LossTolerantTracker(config, thinned.anchors)
        estimates = [e for epoch in epochs_of(thinned, -1, Counter()) for e in tracker.step(epoch)]
        scores.append(score(estimates, thinned.truth[estimates[0].target_id], bags.skip_s))
    return pool(scores)


def lias_lost(sets: Sets) -> Result:
    """UWB on a trolley whose ranges get lost; radios: the first 15 s, which are not scored; losses drawn five times."""
    bags = sets.bags('lias')
    calibrated = {'channel': bags.channel}
    result: Result = {'seeds': list(SEEDS), 'scored_from_s': bags.skip_s}
    for rate in (0.0, 0.5, 0.9):
        table: dict[str, Any] = {name: _of(bags, Loss(rate), {**calibrated, 'filter': name}) for name in FILTERS}
        table['ckf_uncalibrated'] = _of(bags, Loss(rate), {})
        if rate:
            table.update(
                {f'ckf_{kind}': _of(bags, loss._replace(rate=rate), calibrated) for kind, loss in KINDS.items()}
            )
        result[f'loss_{rate:g}'] = table
    worst, whole = (result[f'loss_{rate}']['ckf']['rmse_m'] for rate in ('0.9', '0'))
    result['rmse_at_90_percent_of_that_at_0'] = float(np.round(worst / whole, 3))
    return result


def _of(bags: Bags, loss: Loss, settings: Values) -> Result:
    return figures(scored(bags, loss, settings))


TABLES: Mapping[str, Callable[[Sets], Result]] = {'lias_lost': lias_lost}

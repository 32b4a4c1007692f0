"""Scores for machines."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from wsn_tracking.evaluation.score import Score
from wsn_tracking.evaluation.summary import Summary, pool_summaries
from wsn_tracking.files import write_whole


def to_json(summaries: Summary | Sequence[Summary]) -> dict[str, Any]:
    """Plain dicts, lists, numbers and None (what is not known), keys always in the same order.

    One bag: its `title`, `target_id`, `epochs`, `skip_s`, `outputs` by name, `measurements` and `input`
    (counts by reason). Several: these under `bags` in the order given, and over all epochs under `pooled`.
    """
    if isinstance(summaries, Summary):
        return _summary(summaries)
    if len(summaries) == 1:
        return _summary(summaries[0])
    return {'bags': [_summary(s) for s in summaries], 'pooled': _summary(pool_summaries(summaries))}


def to_text(summaries: Summary | Sequence[Summary]) -> str:
    """The same as indented JSON text; strict (no NaN), equal input gives equal text."""
    return json.dumps(to_json(summaries), indent=2, allow_nan=False, ensure_ascii=False) + '\n'


def write_json(path: str | Path, summaries: Summary | Sequence[Summary]) -> None:
    """Write it whole or not at all; TrackingError where that is impossible."""
    write_whole(path, to_text(summaries).encode())


def _summary(summary: Summary) -> dict[str, Any]:
    traffic = summary.traffic
    return {
        'title': summary.title,
        'target_id': summary.target_id,
        'epochs': summary.epochs,
        'skip_s': _number(summary.skip_s),
        'outputs': {name: _score(score) for name, score in summary.outputs.items()},
        'measurements': {**traffic._asdict(), 'sent_share': _number(traffic.share)},
        'input': {reason: int(summary.input[reason]) for reason in sorted(summary.input)},
    }


def _score(score: Score) -> dict[str, Any]:
    return {
        'rmse_m': _number(score.rmse_m),
        'median_m': _number(score.median_m),
        'p95_m': _number(score.p95_m),
        'ei_m': _number(score.ei_m),
        'esi_m': [_number(value) for value in score.esi_m],
        'nees': _number(score.nees),
        'nees_interval': [_number(value) for value in score.nees_interval],
        'nees_interval_independent': [_number(value) for value in score.nees_interval_independent],
        'nees_epochs': score.nees_epochs,
        'nees_effective_epochs': _number(score.nees_effective_epochs),
        'epochs': score.epochs,
        'first_stamp_ns': score.first_ns if score.epochs else None,
        'last_stamp_ns': score.last_ns if score.epochs else None,
        'runs': score.runs,
        'unscored': dict(score.unscored),
        'without_nees': dict(score.without_nees),
    }


def _number(value: float) -> float | None:
    """JSON knows neither NaN nor infinity."""
    return float(value) if math.isfinite(value) else None

"""Where calibrations come from: a survey that was recorded as one, or any bag with truth."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np

from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation.interpolation import truth_at
from wsn_tracking.sensing.average import usable
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.sensing.survey import Readings, Survey, survey_of
from wsn_tracking.sensing.values import Range, Request, Rssi

SURVEYS = {  # file that tells the set
    '*.hst': 'danis',
    'calibration_df.csv': 'kolakowski',
}


class Found(NamedTuple):
    """What there is to calibrate from."""

    survey: Survey
    ranges: bool  # ranges, or signal strengths
    origin: Mapping[str, str]


def open_survey(src: Path | str, until: float | None = None, namespace: str | None = None) -> Found:
    """The survey at a path: the folder of a set that has one (docs/datasets.md), or a bag with truth.

    until [s]: of a bag, what was heard before that time after its first message; the rest stays unseen, to check.
    """
    path = Path(src)
    if not path.exists():
        raise TrackingError(f'{path} does not exist: a bag with truth or the folder of a survey is expected')
    kind = _set_at(path)
    if kind is None:
        return _of_bag(path, until, namespace)
    if until is not None:
        raise TrackingError(f'{path} is a survey of places ({kind}), which has no time: leave out --until')
    if kind == 'danis':
        from wsn_tracking.bags.importing import danis

        survey, source = danis.survey(path)[1], danis.SOURCE
    else:
        from wsn_tracking.bags.importing import kolakowski

        survey, source = kolakowski.survey(path)[1], kolakowski.SOURCE
    return Found(survey, False, {'survey': source, **_size(survey)})


def _set_at(path: Path) -> str | None:
    """Which set the folder is of; None for a bag."""
    if not path.is_dir() or (path / 'metadata.yaml').exists() or any(path.glob('*.mcap')):
        return None
    for pattern, kind in SURVEYS.items():
        if next(path.rglob(pattern), None) is not None:
            return kind
    raise TrackingError(
        f'{path} is neither a bag (metadata.yaml, *.mcap) nor the folder of a survey ({", ".join(SURVEYS)}): '
        'give one of these'
    )


def _of_bag(path: Path, until: float | None, namespace: str | None) -> Found:
    from wsn_tracking.bags.read import read

    recording = read(path, namespace)
    if not recording.truth:
        raise TrackingError(f'{path} holds no truth/target_<id>: without it nobody knows the distances')
    readings, ranges = _readings(recording, until, path)
    survey = survey_of(readings, recording.anchors, ranges=ranges)
    source = recording.metadata.get('source', '')
    slice_ = {} if until is None else {'until': f'{until:g} s after the first message'}
    named = {'source': source} if source else {}
    return Found(survey, ranges, {'bag': path.resolve().name, **named, **slice_, **_size(survey)})


def _readings(recording: Recording, until: float | None, path: Path) -> tuple[Readings, bool]:
    """Every usable measurement whose target's place is known, and whether they are ranges."""
    measured = [m for m in recording.messages if isinstance(m, (Rssi, Range)) and usable(m)]
    heard = [m for m in measured if m.target_id in recording.truth]
    stamps = np.array([m.stamp_ns for m in heard], dtype=np.int64)
    first = min((m.stamp_ns for m in recording.messages if isinstance(m, (Request, Rssi, Range))), default=0)
    targets = np.array([m.target_id for m in heard])
    positions = np.full((len(heard), 3), np.nan)
    for target, truth in recording.truth.items():
        rows = np.flatnonzero(targets == target)
        positions[rows] = truth_at(truth, stamps[rows]).positions
    use = np.all(np.isfinite(positions), axis=1)
    if until is not None:
        use &= stamps - first < until * 1e9
    if not np.any(use):
        limit = '' if until is None else f' within {until:g} s'
        raise TrackingError(
            f'{path} holds no signal strength or range{limit} at a time when the truth of its target is known '
            f'({len(heard)} usable ones in all): nothing can be calibrated from it'
        )
    ranges = recording.entry_level == 'range'
    values = np.array([m.range if isinstance(m, Range) else m.rssi_dbm for m in heard])
    ids = np.array([m.node_id for m in heard], dtype=np.int64)
    return Readings(positions[use], ids[use], values[use]), ranges


def _size(survey: Survey) -> dict[str, str]:
    known = survey.known
    told = survey.counts[known]
    readings = {'readings': f'{told.sum():.0f}'} if np.all(np.isfinite(told)) else {}
    return {'places': str(int(known.any(axis=1).sum())), **readings}

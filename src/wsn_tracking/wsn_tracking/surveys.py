"""Where calibrations come from: a survey that was recorded as one, or any bag with truth."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wsn_tracking.bags.importing.common import is_called
from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation.interpolation import truth_at
from wsn_tracking.models.anchors import Anchors, Floats
from wsn_tracking.sensing.average import usable
from wsn_tracking.sensing.body_fit import facing
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.sensing.survey import Readings, Survey, survey_of
from wsn_tracking.sensing.values import Range, Request, Rssi

SURVEYS = {  # file that tells the set
    '*.hst': 'danis',
    'calibration_df.csv': 'kolakowski',
}


class Walk(NamedTuple):
    """Signal strengths of a node that is worn, in the order of time."""

    readings: Readings
    facing: Floats  # (M,) [rad] where the body faces; NaN: not known
    anchors: Anchors
    origin: Mapping[str, str]


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
    files = list(path.rglob('*'))
    for pattern, kind in SURVEYS.items():
        if any(is_called(file, pattern) for file in files):
            return kind
    raise TrackingError(
        f'{path} is neither a bag (metadata.yaml, *.mcap) nor the folder of a survey ({", ".join(SURVEYS)}): '
        'give one of these'
    )


def open_walk(path: Path | str, until: float | None = None, namespace: str | None = None) -> Walk:
    """The signal strengths of a bag with truth; `until` as in `open_survey`."""
    path = Path(path)
    if path.is_dir() and _set_at(path) is not None:
        raise TrackingError(f'{path} is a survey of places, nobody wears a node in it: give a bag with truth')
    recording = _bag_with_truth(path, namespace)
    readings, ranges, rows = _readings(recording, until, path)
    if ranges:
        raise TrackingError(f'{path} holds ranges, a body is one of signal strengths: leave out --body')
    facing_at = np.full(len(readings.values), np.nan)
    for target, truth in recording.truth.items():
        of_target = rows.targets == target
        way = facing(truth.stamps_ns, truth.positions, truth.velocities, truth.headings)
        at = np.clip(np.searchsorted(truth.stamps_ns, rows.stamps[of_target], side='right') - 1, 0, way.size - 1)
        facing_at[of_target] = way[at]
    return Walk(readings, facing_at, recording.anchors, _named(recording, until, path))


def _bag_with_truth(path: Path, namespace: str | None) -> Recording:
    from wsn_tracking.bags.read import read

    recording = read(path, namespace)
    if not recording.truth:
        raise TrackingError(f'{path} holds no truth/target_<id>: without it nobody knows the distances')
    return recording


def _of_bag(path: Path, until: float | None, namespace: str | None) -> Found:
    recording = _bag_with_truth(path, namespace)
    readings, ranges, _ = _readings(recording, until, path)
    survey = survey_of(readings, recording.anchors, ranges=ranges)
    return Found(survey, ranges, {**_named(recording, until, path), **_size(survey)})


def _named(recording: Recording, until: float | None, path: Path) -> dict[str, str]:
    """What a bag is."""
    source = recording.metadata.get('source', '')
    slice_ = {} if until is None else {'until': f'{until:g} s after the first message'}
    return {'bag': path.resolve().name, **({'source': source} if source else {}), **slice_}


class Rows(NamedTuple):
    """Whose and when readings are, (M,) each."""

    targets: NDArray[np.int64]
    stamps: NDArray[np.int64]  # [ns]


def _readings(recording: Recording, until: float | None, path: Path) -> tuple[Readings, bool, Rows]:
    """Every usable measurement whose target's place is known, and whether they are ranges."""
    measured = [m for m in recording.messages if isinstance(m, (Rssi, Range)) and usable(m)]
    heard = [m for m in measured if m.target_id in recording.truth]
    stamps = np.array([m.stamp_ns for m in heard], dtype=np.int64)
    first = min((m.stamp_ns for m in recording.messages if isinstance(m, (Request, Rssi, Range))), default=0)
    targets = np.array([m.target_id for m in heard], dtype=np.int64)
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
    return Readings(positions[use], ids[use], values[use]), ranges, Rows(targets[use], stamps[use])


def _size(survey: Survey) -> dict[str, str]:
    known = survey.known
    told = survey.counts[known]
    readings = {'readings': f'{told.sum():.0f}'} if np.all(np.isfinite(told)) else {}
    return {'places': str(int(known.any(axis=1).sum())), **readings}

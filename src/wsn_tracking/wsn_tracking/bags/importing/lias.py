"""Import the trolley of LIAS: three UWB tags, eight anchors, motion capture of the tags' rigid body.

Planar_Dataset/Dynamic of LIAS-CUHKSZ/Efficient-Pose-Estimation-via-UWB-measurements (MIT).
`UWB_*.csv`: local time, then 24 ranges [m], anchor by anchor, three tags each, about 100 times a second.
`motion_capture_*.csv`: local time, x, y, z [m] of the centroid, and a quaternion that is not needed.
"""

from __future__ import annotations

import math
from collections import Counter
from datetime import datetime, timezone
from pathlib import Path
from typing import NamedTuple

import numpy as np

from wsn_tracking.bags.importing.common import (
    Dropped,
    beside,
    box,
    comma_separated,
    find,
    lines_of,
    nanoseconds,
    numbers,
    positive,
    recording,
    track,
)
from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import Floats, make_anchors
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.sensing.values import Epoch, Modality, Range

SOURCE = 'github LIAS-CUHKSZ/Efficient-Pose-Estimation-via-UWB-measurements @cabd3923'
RATE = 10.0  # [Hz]
TRUTH_S = 0.05  # the trolley moves 1 cm in this time
TARGET = 1
HEIGHT = 0.97  # [m] of the tags
TAGS = 3
ANCHORS = (  # [m]
    (-3.4203, 3.0053, 1.0442),
    (0.0016, 3.0110, 1.0446),
    (3.6056, 2.9795, 1.0463),
    (3.6011, -0.0008, 1.0422),
    (3.5674, -3.0087, 1.0443),
    (-0.0072, -2.9652, 1.0444),
    (-3.4673, -2.9587, 1.0445),
    (-3.4858, -0.0098, 1.0457),
)
LEVERS = ((-0.0689, -0.1423), (-0.0750, 0.1402), (0.2034, 0.1451))  # [m] of the tags from the centroid


class Sample(NamedTuple):
    """One line of ranges."""

    stamp_ns: int
    ranges: Floats  # (8, 3) [m], NaN where there is none


def load(src: Path, rate: float = RATE) -> Recording:
    """The nearest sample to every 1 / `rate` [Hz], its ranges those of the centroid.

    A range to the centroid is the average of the three tags' ranges with the weights that let their lever
    arms cancel (sum w = 1, sum w lever = 0): right to first order at every heading, which need not be known.
    Where one tag's range is missing, the anchor is left out (`tag_missing`).
    """
    if not 0.01 <= rate <= 1000.0:
        raise TrackingError(f'rate {rate:g} Hz: 0.01 to 1000 Hz are expected, e.g. {RATE:g}')
    ranged = find(src, 'UWB_*.csv')
    dropped: Dropped = Counter()
    samples = nearest(_samples(ranged, dropped), 1.0 / rate)
    epochs = []
    for sample in samples:
        values = sample.ranges @ weights()
        missing = np.isnan(values) & np.any(np.isfinite(sample.ranges), axis=1)
        dropped['tag_missing'] += int(np.count_nonzero(missing))
        heard = [(node, z) for node, z in enumerate(values.tolist()) if np.isfinite(z)]
        packets = tuple(Range(sample.stamp_ns, node, TARGET, 0, 0, Modality.UWB, z) for node, z in heard)
        epochs.append(Epoch(TARGET, 0, sample.stamp_ns, packets))
    metadata = {
        'area': box(ANCHORS),
        'target_height': f'{HEIGHT:g}',
        'configuration': 'lias',
        'source': f'{SOURCE} {ranged.name}',
    }
    twin = f'motion_capture_{ranged.name.lower().removesuffix(".gz")[len("UWB_") :]}'
    truth = _truth(beside(ranged.parent, twin), dropped)
    anchors = make_anchors(range(len(ANCHORS)), ANCHORS)
    return recording(epochs, anchors, [track(TARGET, truth, TRUTH_S)], metadata, dropped)


def weights() -> Floats:
    """(3,) of the tags: they sum to one and their lever arms to nothing."""
    return np.linalg.solve(np.vstack([np.ones(TAGS), np.array(LEVERS).T]), [1.0, 0.0, 0.0])


def nearest(samples: list[Sample], period_s: float) -> list[Sample]:
    """Of samples ascending in time, the nearest to every period since the first; none where half a period has none."""
    stamps = np.array([sample.stamp_ns for sample in samples], dtype=np.int64)
    if not stamps.size:
        return []
    period = round(period_s * 1e9)
    which = np.unique((stamps - stamps[0] + period // 2) // period)  # periods with a sample within half of one
    wanted = stamps[0] + which * period
    after = np.clip(np.searchsorted(stamps, wanted), 1, max(stamps.size - 1, 1))
    before = after - 1
    after = np.minimum(after, stamps.size - 1)
    return [samples[i] for i in np.where(wanted - stamps[before] <= stamps[after] - wanted, before, after).tolist()]


def _samples(path: Path, dropped: Dropped) -> list[Sample]:
    samples = []
    for line in lines_of(path):
        cells = comma_separated(line)
        try:
            if len(cells) != 1 + TAGS * len(ANCHORS):
                raise ValueError('wrong_columns')  # noqa: TRY301
            stamp = _stamp(cells[0])
        except ValueError as reason:
            dropped[str(reason)] += 1
            continue
        values = [_range(cell, dropped) for cell in cells[1:]]
        samples.append(Sample(stamp, np.array(values).reshape(-1, TAGS)))
    return sorted(samples, key=lambda sample: sample.stamp_ns)


def _range(cell: str, dropped: Dropped) -> float:
    """A range, NaN where there is none."""
    try:
        return positive(*numbers([cell])) if cell else math.nan
    except ValueError as reason:
        dropped[str(reason)] += 1
        return math.nan


def _truth(path: Path, dropped: Dropped) -> list[tuple[int, list[float]]]:
    rows = []
    for line in lines_of(path)[1:]:
        cells = comma_separated(line)
        try:
            if len(cells) < 4:
                raise ValueError('wrong_columns')  # noqa: TRY301
            rows.append((_stamp(cells[0]), numbers(cells[1:4])))
        except ValueError as reason:
            dropped[f'truth_{reason}'] += 1
    return rows


def _stamp(text: str) -> int:
    """Local time 2022-08-15 9:37:27.039, whose zone nobody tells, read as UTC; ValueError with the reason."""
    whole, _, part = text.partition('.')
    try:
        moment = datetime.strptime(whole, '%Y-%m-%d %H:%M:%S').replace(tzinfo=timezone.utc)
    except ValueError:
        raise ValueError('not_a_time') from None
    return nanoseconds(f'{int(moment.timestamp())}.{part or 0}')

"""Import a UTIAS multi-robot set: five robots at once, each with a camera that ranges fixed landmarks.

Cite Leung, Halpern, Barfoot, Liu, The UTIAS multi-robot cooperative localization and mapping dataset, IJRR
30(8), 2011. `RobotN_Measurement.dat`: stamp [s], barcode, range [m], bearing [rad]; `Barcodes.dat`: subject,
barcode; `Landmark_Groundtruth.dat`: subject, x, y [m], deviations; `RobotN_Groundtruth.dat`, plain or .gz:
stamp [s], x, y [m], heading [rad]. Subjects 1 to 5 are the robots, 6 to 20 the landmarks; # begins a comment.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from wsn_tracking.bags.importing.common import (
    Dropped,
    beside,
    box,
    find,
    grouped,
    nanoseconds,
    numbered,
    numbers,
    positive,
    recording,
    track,
    unusable,
)
from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.sensing.recording import Recording, Truth
from wsn_tracking.sensing.values import Epoch, Modality, Range

SOURCE = 'UTIAS MRCLAM, github ericguerrero/MUSI-lab-session-1 @d1184441'
ROBOTS = range(1, 6)
FRAME_S = 0.02  # the stamps of one picture differ by a millisecond, pictures by 120
TRUTH_S = 0.1
MARGIN = 2.0  # [m] by which the robots may leave the rectangle of the landmarks


def load(src: Path) -> Recording:
    """The robots are targets, the landmarks nodes; what one picture shows of landmarks is an epoch of its robot."""
    folder = find(src, 'Robot1_Measurement.dat').parent
    dropped: Dropped = Counter()
    subjects = {int(code): int(subject) for subject, code in _checked(beside(folder, 'Barcodes.dat'), 2)}
    landmarks = {int(node): (x, y) for node, x, y in _checked(beside(folder, 'Landmark_Groundtruth.dat'), 3)}
    epochs: list[Epoch] = []
    truth = []
    for robot in ROBOTS:
        measured = beside(folder, f'Robot{robot}_Measurement.dat')
        if measured.is_file():
            seen = sorted(_seen(measured, robot, subjects, landmarks, dropped), key=lambda packet: packet.stamp_ns)
            epochs += grouped(seen, FRAME_S)
            truth.append(_truth(folder, robot, dropped))
    anchors = make_anchors(list(landmarks), list(landmarks.values()))
    metadata = {
        'area': box(anchors.positions, MARGIN),
        'target_height': '0',
        'configuration': 'mrclam',
        'source': f'{SOURCE} {folder.name}',
    }
    return recording(epochs, anchors, truth, metadata, dropped)


def _seen(
    path: Path, robot: int, subjects: dict[int, int], landmarks: dict[int, tuple[float, float]], dropped: Dropped
) -> Iterator[Range]:
    """A robot's ranges to landmarks; those to other robots are left out (`robot_seen`)."""
    for _, cells in _cells(path):
        try:
            if len(cells) < 3:
                raise ValueError('too_few_columns')  # noqa: TRY301
            stamp, (code, metres) = nanoseconds(cells[0]), numbers(cells[1:3])
            node = subjects.get(int(code), -1)
            if node not in landmarks:
                raise ValueError('robot_seen' if node in ROBOTS else 'unknown_barcode')  # noqa: TRY301
            packet = Range(stamp, node, robot, 0, 0, Modality.OTHER, positive(metres))
        except ValueError as reason:
            dropped[str(reason)] += 1
            continue
        yield packet


def _truth(folder: Path, robot: int, dropped: Dropped) -> Truth:
    rows = []
    for _, cells in _cells(beside(folder, f'Robot{robot}_Groundtruth.dat')):
        try:
            if len(cells) < 3:
                raise ValueError('too_few_columns')  # noqa: TRY301
            rows.append((nanoseconds(cells[0]), (*numbers(cells[1:3]), 0.0)))
        except ValueError as reason:
            dropped[f'truth_{reason}'] += 1
    return track(robot, rows, TRUTH_S)


def _checked(path: Path, count: int) -> list[list[float]]:
    """The first `count` numbers of every line of a table without which nothing can be used."""
    rows = []
    for number, cells in _cells(path):
        try:
            if len(cells) < count:
                raise ValueError(f'{len(cells)}')  # noqa: TRY301
            rows.append(numbers(cells[:count]))
        except ValueError as reason:
            raise unusable(path, number, f'{count} numbers are', reason) from None
    if not rows:
        raise TrackingError(f'{path} holds no line of {count} numbers')
    return rows


def _cells(path: Path) -> Iterator[tuple[int, list[str]]]:
    """Number and cells of every line that is no comment."""
    return ((number, line.split()) for number, line in numbered(path) if not line.startswith('#'))

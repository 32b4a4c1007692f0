"""What the importers share: files, numbers that may be broken, and epochs that become a recording.

A file that is missing or of another format is a TrackingError; a line that cannot be used is left out and
counted by its reason, which ends up in the bag's metadata (`import_dropped`).
"""

from __future__ import annotations

import gzip
import math
import zlib
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from decimal import Decimal, InvalidOperation
from fnmatch import fnmatchcase
from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wsn_tracking.bags.epochs import with_epoch_ends
from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import Anchors, Floats
from wsn_tracking.sensing.recording import Message, Recording, Truth
from wsn_tracking.sensing.values import Epoch, Range, Request, Rssi

Dropped = Counter[str]  # lines or values left out, by reason
Measured = TypeVar('Measured', Rssi, Range)

SHORTEST_S = 0.005  # a shorter period is no period of a radio: none is told
LAST_S = 2**31  # stamps end here [s]
PACKED = b'\x1f\x8b'  # how a gzip file begins
MAX_M = 1e4  # no radio of a sensor network, and no room, reaches further


def find(src: Path, pattern: str) -> Path:
    """The one file of that name at `src` or in its folders; TrackingError where there is none, or several.

    Names are matched in any case, and packed as .gz or not.
    """
    if src.is_file():
        if not is_called(src, pattern):
            raise TrackingError(f'{src} is no {pattern}: give the folder of the recording')
        return src
    try:
        found = sorted(path for path in src.rglob('*') if is_called(path, pattern) and path.is_file())
    except OSError as error:
        raise TrackingError(f'{src} cannot be searched: {error.strerror}') from error
    if not found:
        raise TrackingError(f'{src} holds no {pattern} (looked in all its folders): give the folder of the recording')
    if len(found) > 1:
        listed = ', '.join(path.relative_to(src).as_posix() for path in found[:5])
        raise TrackingError(f'{src} holds {len(found)} of {pattern} ({listed}): give the one that is meant')
    return found[0]


def beside(folder: Path, name: str) -> Path:
    """The file of that name in a folder, in any case and packed as .gz or not; the bare name where there is none."""
    return next((path for path in sorted(folder.iterdir()) if is_called(path, name)), folder / name)


def is_called(path: Path, pattern: str) -> bool:
    """Whether the name of a file is of a pattern, in any case and packed as .gz or not."""
    return fnmatchcase(path.name.lower().removesuffix('.gz'), pattern.lower())


def numbered(path: Path) -> list[tuple[int, str]]:
    """Number and text of every line that is not empty; what gzip has packed is unpacked, a byte order mark dropped."""
    try:
        raw = path.read_bytes()
        text = (gzip.decompress(raw) if raw.startswith(PACKED) else raw).decode('utf-8-sig', errors='replace')
    except (OSError, EOFError, zlib.error) as error:
        raise TrackingError(f'{path} cannot be read: {getattr(error, "strerror", None) or error}') from error
    return [(number, line.strip()) for number, line in enumerate(text.splitlines(), start=1) if line.strip()]


def lines_of(path: Path) -> list[str]:
    """The lines of a text without empty ones, see `numbered`."""
    return [line for _, line in numbered(path)]


def comma_separated(line: str) -> list[str]:
    """The cells of a line without the blanks and quotes round them."""
    return [cell.strip().strip('"') for cell in line.split(',')]


def unusable(path: Path, number: int, expected: str, reason: object) -> TrackingError:
    """What is told of a line without which nothing can be used."""
    return TrackingError(f'{path}, line {number}: {expected} expected, found {str(reason).replace("_", " ")}')


def numbers(cells: Sequence[str], limit: float = MAX_M) -> list[float]:
    """Every cell as a finite number of at most `limit` in size; ValueError with the reason where one is none."""
    try:
        values = [float(cell) for cell in cells]
    except ValueError:
        raise ValueError('not_a_number') from None
    if not all(abs(value) <= limit for value in values):
        raise ValueError('absurd_number')
    return values


def nanoseconds(text: str | float, exponent: int = 0) -> int:
    """A stamp in units of 10^exponent s as integer nanoseconds (text keeps its digits); ValueError with the reason."""
    try:
        exact = Decimal(text).scaleb(exponent)
    except InvalidOperation:
        raise ValueError('not_a_number') from None
    if not exact.is_finite() or not 0 <= exact < LAST_S:
        raise ValueError('absurd_stamp')
    return round(exact * 10**9)


def positive(metres: float) -> float:
    """A range that can be true; ValueError with the reason."""
    if not 0.0 < metres <= MAX_M:
        raise ValueError('absurd_range')
    return metres


def track(target_id: int, rows: Iterable[tuple[int, Sequence[float]]], shortest_s: float = 0.0) -> Truth:
    """A truth from (stamp_ns, (x, y, z)) in any order, thinned so that neighbours are `shortest_s` apart."""
    kept: list[tuple[int, Sequence[float]]] = []
    for stamp, position in sorted(rows, key=lambda row: row[0]):
        if not kept or stamp - kept[-1][0] >= max(round(shortest_s * 1e9), 1):
            kept.append((stamp, position))
    stamps: NDArray[np.int64] = np.array([stamp for stamp, _ in kept], dtype=np.int64)
    positions: Floats = np.array([position for _, position in kept], dtype=np.float64).reshape(-1, 3)
    return Truth(target_id, stamps, positions, np.full(positions.shape, math.nan))


def grouped(packets: Iterable[Measured], within_s: float) -> list[Epoch]:
    """Measurements of one target, ascending in time, as epochs: those within `within_s` of an epoch's first."""
    groups: list[list[Measured]] = []
    for packet in packets:
        if groups and packet.stamp_ns - groups[-1][0].stamp_ns <= within_s * 1e9:
            groups[-1].append(packet)
        else:
            groups.append([packet])
    return [Epoch(group[0].target_id, 0, group[0].stamp_ns, tuple(group)) for group in groups]


def singles(packets: Iterable[Measured], dropped: Dropped) -> list[Epoch]:
    """Each measurement of a target as an epoch; other nodes at its stamp join it, a node's second one is left out."""
    at: dict[int, dict[int, Measured]] = defaultdict(dict)
    for packet in packets:
        if packet.node_id in at[packet.stamp_ns]:
            dropped['repeated_stamp'] += 1
        else:
            at[packet.stamp_ns][packet.node_id] = packet
    return [Epoch(next(iter(of.values())).target_id, 0, stamp, tuple(of.values())) for stamp, of in at.items()]


def box(positions: ArrayLike, margin: float = 0.0) -> str:
    """The metadata `area` of the rectangle round (N, 2 or 3) positions [m]."""
    xy = np.asarray(positions, dtype=np.float64)[:, :2]
    edges = (*(xy.min(axis=0) - margin), *(xy.max(axis=0) + margin))
    return ' '.join(f'{edge:.6g}' for edge in edges)


def recording(
    epochs: Iterable[Epoch],
    anchors: Anchors,
    truth: Iterable[Truth],
    metadata: Mapping[str, str],
    dropped: Dropped,
) -> Recording:
    """Epochs of any order, numbers ignored, as a recording with requests and EpochEnds.

    Epochs are numbered per target in the order of time, measurements per node and target; an epoch at a
    stamp that its target has had is left out (`repeated_stamp`). Raises where nothing is left.
    """
    seen: dict[int, list[int]] = defaultdict(list)  # stamps of each target
    sent: Counter[tuple[int, int]] = Counter()
    messages: list[Message] = []
    for epoch in sorted(epochs, key=lambda e: (e.stamp_ns, e.target_id)):
        stamps = seen[epoch.target_id]
        if stamps and stamps[-1] == epoch.stamp_ns:
            dropped['repeated_stamp'] += 1
            continue
        asked = Request(epoch.stamp_ns, epoch.target_id, len(stamps))
        stamps.append(epoch.stamp_ns)
        messages.append(asked)
        for m in epoch.measurements:
            seq = sent[m.target_id, m.node_id]
            sent[m.target_id, m.node_id] += 1
            messages.append(m._replace(stamp_ns=asked.stamp_ns, request_seq=asked.seq, seq=seq))
    measured = [message for message in messages if not isinstance(message, Request)]
    reasons = ', '.join(f'{reason} {count}' for reason, count in sorted(dropped.items()) if count)
    if not measured:
        raise TrackingError(f'{metadata["source"]}: no measurement can be used ({reasons or "the file is empty"})')
    level = 'rssi' if isinstance(measured[0], Rssi) else 'range'
    told = {'entry_level': level, **metadata, 'import_dropped': reasons or 'nothing'}
    gaps = np.concatenate([np.diff(stamps) for stamps in seen.values()]) / 1e9
    if gaps.size and np.median(gaps) >= SHORTEST_S:
        told['period'] = f'{np.median(gaps):.4f}'
    tracks = {t.target_id: t for t in truth if t.stamps_ns.size}
    return with_epoch_ends(Recording(anchors, level, tuple(messages), tracks, told, {}))

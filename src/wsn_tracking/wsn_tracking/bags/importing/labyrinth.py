"""Import the labyrinth of libRSF: a robot in a square of 2.4 m ranges one of four UWB modules at a time.

datasets/Indoor_UWB of TUC-ProAut/libRSF (CC BY-SA 4.0). `range2`: stamp [s], range [m], a variance that is the
same in all lines, module x, y [m], module, signal-to-noise ratio; `point2`: stamp [s], x, y [m]. The wheels
(`odom2diff`) are left out: no tracker here takes them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from wsn_tracking.bags.importing.common import (
    Dropped,
    box,
    find,
    lines_of,
    nanoseconds,
    numbers,
    positive,
    recording,
    singles,
    track,
)
from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.sensing.values import Modality, Range

SOURCE = 'github TUC-ProAut/libRSF @d54801a2'
TARGET = 1


def load(src: Path) -> Recording:
    """Every range is an epoch of its own, but for those of one stamp; a module is where its first line says."""
    ranged = find(src, 'Indoor_UWB_Input.txt')
    dropped: Dropped = Counter()
    modules: dict[int, list[float]] = {}
    packets = []
    for stamp, (metres, _, x, y, module) in _records(ranged, 'range2', 5, dropped):
        try:
            node = int(module)
            if modules.setdefault(node, [x, y]) != [x, y]:
                raise ValueError('moved_module')  # noqa: TRY301
            packet = Range(stamp, node, TARGET, 0, 0, Modality.UWB, positive(metres))
        except ValueError as reason:
            dropped[str(reason)] += 1
            continue
        packets.append(packet)
    if not modules:
        raise TrackingError(f'{ranged} holds no line `range2 ...` that can be used')
    points = _records(find(src if src.is_dir() else src.parent, 'Indoor_UWB_GT.txt'), 'point2', 2, dropped)
    truth = track(TARGET, [(stamp, (*place, 0.0)) for stamp, place in points])
    anchors = make_anchors(list(modules), list(modules.values()))
    metadata = {
        'area': box(anchors.positions),
        'target_height': '0',
        'configuration': 'labyrinth',
        'source': SOURCE,
    }
    return recording(singles(packets, dropped), anchors, [truth], metadata, dropped)


def _records(path: Path, kind: str, count: int, dropped: Dropped) -> Iterator[tuple[int, list[float]]]:
    """Stamp and the first `count` numbers after it of every line of a kind."""
    for line in lines_of(path):
        name, *cells = line.split()
        if name != kind:
            if name != 'odom2diff':
                dropped['unknown_record'] += 1
            continue
        try:
            if len(cells) <= count:
                raise ValueError('too_few_columns')  # noqa: TRY301
            record = nanoseconds(cells[0]), numbers(cells[1 : 1 + count])
        except ValueError as reason:
            dropped[str(reason)] += 1
            continue
        yield record

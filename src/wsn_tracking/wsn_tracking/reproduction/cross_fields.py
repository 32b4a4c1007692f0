"""The recordings that all systems are compared on, and what every system is told of them."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

from wsn_tracking import graphs
from wsn_tracking.bags.epochs import with_epoch_ends
from wsn_tracking.bags.importing.run import import_set
from wsn_tracking.evaluation.score import SKIP_S
from wsn_tracking.graphs.facts import Facts
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.sensing.values import NAN, Rssi
from wsn_tracking.simulation.record import record
from wsn_tracking.simulation.scenarios import scenario
from wsn_tracking.studies.real_radio.sets import MRCLAM, SETS, Set, find, prepare

Opened = tuple[graphs.Source, Recording]


class Field(NamedTuple):
    """One recording, or several that are scored together."""

    name: str
    what: str
    facts: Facts
    real: bool = False


FIELDS = (
    Field('a_loop', 'simulated: robot, RSSI, 12 nodes, 3.6 x 2.4 m', Facts(0.06, 1.6e-3, 5.0, 1.9, 3)),
    Field(
        'c_walk',
        'simulated: person, RSSI, 16 nodes, 100 x 100 m',
        Facts(1.0, 0.1, 10.0, 48.0, 4, sigma_db=7.2, person=True),
    ),
    Field(
        'danis',
        'person with a BLE beacon, RSSI, 12 nodes, 20 x 17 m, four tracks',
        Facts(0.7, 0.05, 20.0, 12.0, 3, dof=4.0),
        real=True,
    ),
    Field('kolakowski', 'robot with a BLE tag in a flat, RSSI, 6 nodes', Facts(0.2, 0.01, 20.0, 8.0, 3, dof=4.0), True),
    Field('lias', 'trolley, UWB, 8 nodes, 7 x 6 m', Facts(0.3, 0.05, 20.0, 8.0, 3, range_std=0.1), True),
    Field('plaza2', 'lawnmower outdoors, ranging radio, 4 nodes', Facts(1.0, 0.5, 30.0, 80.0, 2, range_std=0.6), True),
    Field(
        'labyrinth',
        'small robot among walls, UWB, 4 nodes',
        Facts(0.3, 0.05, 30.0, 3.0, 2, range_std=0.12, dof=5.0),
        True,
    ),
    Field(
        'mrclam',
        'five robots that see landmarks at times, ranges, 15 nodes',
        Facts(0.1, 0.02, 20.0, 5.5, 3, range_std=0.2),
        True,
    ),
    Field('zignav', 'ZigBee node at rest, RSSI, 4 nodes, every 12 s', Facts(0.01, 1e-6, 1.0, 20.0, 2), True),
)
PLAIN = {set_.kind: set_ for set_ in (MRCLAM, Set('zignav', 'ZigNav_logs*'))}  # whose radios nothing calibrates


def simulated(name: str, seed: int) -> Opened:
    """The recording of a scenario, as its bag holds it."""
    made = with_epoch_ends(record(scenario(name, seed=seed), seed))
    return graphs.source_of(name, made), made


def without_bodies(recording: Recording, sigma_db: float) -> Recording:
    """The recording as a filter must take it that knows no bodies: every signal strength is less certain."""
    anchors = recording.anchors._replace(sigma_db=np.full_like(recording.anchors.sigma_db, sigma_db))
    messages = tuple(m._replace(sigma_db=NAN) if isinstance(m, Rssi) else m for m in recording.messages)
    return recording._replace(anchors=anchors, messages=messages)


class Ready(NamedTuple):
    """A real recording, imported."""

    bags: tuple[str, ...]
    skip_s: float  # first part, that is not scored


def real(name: str, data: Path, work: Path) -> Ready:
    """Import a set below `data` into `work`; its radios are calibrated by a survey, or by what is not scored."""
    if name in PLAIN:
        return Ready(tuple(map(str, import_set(name, find(data, PLAIN[name]), work / name))), SKIP_S)
    wanted, ready = SETS[name], prepare(data, name, work / 'plain')
    source, out = find(data, wanted), work / 'calibrated' / name
    return Ready(tuple(map(str, import_set(wanted.kind, source, out, wanted.rate, ready.channel))), ready.skip_s)

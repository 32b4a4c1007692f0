"""What a claim is: what a document says, how it is measured, and between which bounds it counts as found."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

from wsn_tracking.models.anchors import Floats
from wsn_tracking.studies.intervals import Figure as Interval

# Quantities by name. (runs, ...), independent from run to run; a name that begins with PICTURE is one run's, for a
# plot, and one that begins with MEASURED tells of the machine, not of the seed.
Samples = Mapping[str, Floats]
PICTURE, MEASURED = 'picture ', 'measured '

# (seed, runs) -> Samples. Equal arguments give equal samples in every process, but for what is MEASURED.
Sampler = Callable[[int, int], Samples]

Bounds = tuple[float | None, float | None]  # lowest, highest; None: open on that side

DOCUMENT, BEYOND = 'document', 'beyond'


class Experiment(NamedTuple):
    """Runs that one or several claims are measured on, in units that are drawn and computed on their own."""

    name: str  # keys the draws: units of two experiments never share theirs
    sample: Sampler
    runs: int  # of a unit
    units: int
    quick: int  # units of `--quick`: the first of the others


class Figure(NamedTuple):
    """One number of a claim."""

    name: str
    ours: Interval
    unit: str = ''
    document: float | str | None = None  # what the document says; None: nothing
    shape: Bounds | None = None  # where the interval must lie for the claim to hold in kind
    near: Bounds | None = None  # where it must lie for the document's number to be met


class Series(NamedTuple):
    """One line, or one row of bars, of a plot."""

    name: str
    x: Sequence[float | str]
    y: Sequence[float]
    low: Sequence[float] = ()  # of the 95 % interval
    high: Sequence[float] = ()
    style: str = 'line'  # line, points, steps, truth


class Plot(NamedTuple):
    """A picture of a claim; strings as x make it bars."""

    title: str
    x: str
    y: str
    series: Sequence[Series]
    log_x: bool = False
    log_y: bool = False
    equal: bool = False  # a map: both axes alike


class Claim(NamedTuple):
    """One thing that a document says, or that this project adds (`kind` BEYOND)."""

    id: str
    document: str  # A to E
    place: str  # in the document: 'table 1'
    statement: str
    experiment: Experiment | None  # None: nothing to measure, `impossible` says why
    figures: Callable[[Samples], Sequence[Figure]]
    plots: Callable[[Samples], Sequence[Plot]] = lambda samples: ()
    remark: str = ''  # what to make of it
    kind: str = DOCUMENT
    in_kind: bool = False  # the document's own recording is not published: at best its shape can be found
    impossible: str = ''  # why it cannot be reproduced, whatever the figures are


def nothing(samples: Samples) -> Sequence[Figure]:
    """Figures of a claim that cannot be measured."""
    return ()

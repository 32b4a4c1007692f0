"""Floor plans: where a person can be in a building, from a file of corners."""

from __future__ import annotations

import numpy as np

from wsn_tracking.errors import TrackingError
from wsn_tracking.files import read_whole
from wsn_tracking.models.region import Region, region

HEADER = 'x,y'


def read_floor_plan(path: str) -> Region:
    """The region of a CSV file: a corner `x,y` [m] a line, an empty line between the outline and each hole.

    Raises TrackingError where the file cannot be read or a line is no corner.
    """
    try:
        lines = read_whole(path).decode('utf-8-sig').splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise TrackingError(f'floor plan {path} cannot be read: {error}') from error
    rings: list[list[tuple[float, float]]] = [[]]
    for number, line in enumerate(lines, 1):
        text = line.partition('#')[0].strip()
        if not text:
            if rings[-1] and not line.strip():
                rings.append([])
        elif number > 1 or text.replace(' ', '').lower() != HEADER:
            rings[-1].append(_corner(text, f'{path}, line {number}'))
    try:
        return region([np.array(ring) for ring in rings if ring])
    except TrackingError as error:
        raise TrackingError(f'{path}: {error}') from error


def _corner(text: str, where: str) -> tuple[float, float]:
    try:
        x, y = (float(word) for word in text.split(','))
    except ValueError as error:
        raise TrackingError(f'{where} is {text[:60]!r}: expected a corner as x,y in metres') from error
    return x, y

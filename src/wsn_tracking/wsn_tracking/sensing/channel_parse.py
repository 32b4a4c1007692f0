"""The text of a channel read: every value checked, and what is wrong said with its place."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import FURTHEST, Floats
from wsn_tracking.models.anchors import LIMITS as RADIO_LIMITS
from wsn_tracking.models.radio_map import RadioMap, make_map
from wsn_tracking.ros_yaml import parse
from wsn_tracking.sensing.channel import Body, Channel, PathLoss, Quantity, Ranging
from wsn_tracking.sensing.channel_text import FORMAT

LIMITS: Mapping[str, tuple[float, float]] = {  # of values that a radio, or a body beside it, can have
    **RADIO_LIMITS,
    'sigma': (1e-9, 1e4),
    'loss': (-60.0, 60.0),
    'at_1_m': (-100.0, 100.0),
    'per_decade': (-100.0, 100.0),
}
MOST_PLACES = 5000  # a larger map would fill the memory before it served anybody


def parse_channel(text: str, where: str) -> Channel:
    """The channel of a text; TrackingError, which begins with `where`, for what is none."""
    reader = _Reader(where)
    content = parse(text, where)
    if not isinstance(content, dict) or content.get('format') != FORMAT:
        seen = content.get('format') if isinstance(content, dict) else type(content).__name__
        reader.refuse(f'its `format` is {_shown(seen)}', f'`{FORMAT}`, as `wsn-tracking calibrate` writes it')
    known = {'format', 'origin', 'path_loss', 'ranging', 'body', 'map'}
    if unknown := sorted(str(name) for name in content if name not in known):
        reader.refuse(f'it has sections {_shown(unknown)}', ', '.join(sorted(known)))
    loss = reader.radios(content, 'path_loss')
    ranging = reader.radios(content, 'ranging')
    if loss is None and ranging is None:
        reader.refuse('it has neither `path_loss` nor `ranging`', 'at least one of them')
    ids = (loss or ranging)[0]  # type: ignore[index]
    if loss is not None and ranging is not None and loss[0].tolist() != ranging[0].tolist():
        reader.refuse('`path_loss` and `ranging` are of different nodes', 'the same nodes in both')
    radio_map = reader.radio_map(content.get('map'), ids) if content.get('map') is not None else None
    if radio_map is not None and loss is None:
        reader.refuse('it has a `map` without `path_loss`', 'the path loss that the map is about')
    body = reader.body(content['body']) if content.get('body') is not None else None
    if body is not None and loss is None:
        reader.refuse('it has a `body` without `path_loss`', 'the path loss that the body is beside')
    origin = content.get('origin') or {}
    if not isinstance(origin, dict):
        reader.refuse(f'`origin` is {_shown(origin)}', 'names with words')
    return Channel(
        ids,
        None if loss is None else PathLoss(**loss[1]),
        None if ranging is None else Ranging(**ranging[1]),
        radio_map,
        {str(name): str(words) for name, words in origin.items()},
        body,
    )


class _Reader:
    """What the parts of a channel are read and checked with."""

    def __init__(self, where: str) -> None:
        self.where = where

    def refuse(self, seen: str, expected: str) -> NoReturn:
        raise TrackingError(f'channel {self.where}: {seen}; expected {expected}')

    def radios(self, content: Mapping[str, Any], section: str) -> tuple[NDArray[np.int64], dict[str, Any]] | None:
        """Node ids and columns of a section; None where it is not there."""
        nodes = content.get(section)
        if nodes is None:
            return None
        kind: type[Any] = PathLoss if section == 'path_loss' else Ranging
        ids = self.ids(nodes, section)
        columns: dict[str, list[Any]] = {name: [] for name in kind._fields}
        for node in ids:
            cells = nodes[node]
            if not isinstance(cells, dict) or set(cells) != set(columns):
                self.refuse(f'`{section}` of node {node} is {_shown(cells)}', f'values of {", ".join(columns)}')
            for name, cell in cells.items():
                read: Callable[[Any, str, str], Any] = self.quantity if name in LIMITS else self.count
                columns[name].append(read(cell, name, f'`{name}` of node {node}'))
        tables: dict[str, Any] = {}
        for name, column in columns.items():
            tables[name] = Quantity(*np.array(column).T) if name in LIMITS else np.array(column, dtype=np.int64)
        return np.array(ids, dtype=np.int64), tables

    def ids(self, nodes: Any, section: str) -> list[int]:
        if not isinstance(nodes, dict) or not nodes:
            self.refuse(f'`{section}` is {_shown(nodes)}', 'an entry for each node, by its id')
        for node in nodes:
            if not isinstance(node, int) or isinstance(node, bool) or not 0 <= node <= 65535:
                self.refuse(f'`{section}` has an entry {_shown(node)}', 'node ids from 0 to 65535')
        return sorted(nodes)

    def quantity(self, cell: Any, name: str, what: str) -> list[float]:
        values = self.numbers(cell, 4, what)
        low, high = LIMITS[name]
        value, std, lower, upper = values
        if not (low <= value <= high and std >= 0.0 and lower <= value <= upper):
            self.refuse(
                f'{what} is {_shown(cell)}',
                f'a value from {low:g} to {high:g} with a standard deviation, within its interval',
            )
        return values

    def count(self, cell: Any, name: str, what: str) -> int:
        if not isinstance(cell, int) or isinstance(cell, bool) or not 0 <= cell < 2**63:
            self.refuse(f'{what} is {_shown(cell)}', 'a count')
        return cell

    def numbers(self, cell: Any, size: int, what: str) -> list[float]:
        good = isinstance(cell, list) and len(cell) == size
        good = good and all(isinstance(x, (int, float)) and not isinstance(x, bool) and abs(x) < 1e9 for x in cell)
        if not good:
            self.refuse(f'{what} is {_shown(cell)}', f'{size} finite numbers')
        return [float(x) for x in cell]

    def body(self, section: Any) -> Body:
        names = {'loss', 'los', 'nlos', 'sigma_db', 'readings'}
        needed = names - {'los', 'nlos'}
        given = set(section) if isinstance(section, dict) else set()
        if not needed <= given <= names or len(given & {'los', 'nlos'}) == 1:
            self.refuse(f'`body` holds {_shown(section)}', f'{", ".join(sorted(needed))}, and los with nlos or neither')
        (sigma,) = self.numbers([section['sigma_db']], 1, '`sigma_db` of `body`')
        if not LIMITS['sigma_db'][0] <= sigma <= LIMITS['sigma_db'][1]:
            self.refuse(f'`sigma_db` of `body` is {sigma:g}', 'a standard deviation above 0, up to 100 dB')
        counts = section['readings']
        if not isinstance(counts, list) or len(counts) != 2:
            self.refuse(f'`readings` of `body` is {_shown(counts)}', 'two counts')
        front, behind = (self.count(count, 'readings', '`readings` of `body`') for count in counts)
        loss = Quantity(*np.array([self.quantity(section['loss'], 'loss', '`loss` of `body`')]).T)
        return Body(loss, self.line(section, 'los'), self.line(section, 'nlos'), sigma, (front, behind))

    def line(self, section: Mapping[str, Any], side: str) -> Quantity | None:
        cells = section.get(side)
        if cells is None:
            return None
        names = ('at_1_m', 'per_decade')
        if not isinstance(cells, dict) or set(cells) != set(names):
            self.refuse(f'`{side}` of `body` is {_shown(cells)}', ' and '.join(names))
        return Quantity(*np.array([self.quantity(cells[name], name, f'`{name}` of `{side}`') for name in names]).T)

    def radio_map(self, section: Any, ids: NDArray[np.int64]) -> RadioMap:
        names = ('amplitude_db', 'length', 'nodes', 'residual_db', 'noise_db')
        if not isinstance(section, dict) or set(section) != set(names):
            self.refuse(f'`map` holds {_shown(section)}', ', '.join(names))
        amplitude, length = self.numbers([section['amplitude_db'], section['length']], 2, '`map` amplitude and length')
        nodes = section['nodes']
        if self.ids(nodes, 'map nodes') != ids.tolist():
            self.refuse(f'`map` is of nodes {_shown(sorted(nodes))}', f'those of `path_loss`: {ids.tolist()}')
        each = [self.numbers(nodes[node], 4, f'`map` of node {node}') for node in ids.tolist()]
        p1, n, place, packet = np.array(each).T
        residual = self.table(section['residual_db'], 2 + ids.size, 'residual_db')
        noise = self.table(section['noise_db'], 2 + ids.size, 'noise_db')
        if residual.shape != noise.shape or not np.array_equal(residual[:, :2], noise[:, :2]):
            self.refuse('`residual_db` and `noise_db` of `map` are of different places', 'the same x, y in both')
        known = np.isfinite(residual[:, 2:])
        fine = amplitude >= 0.0 and length > 0.0 and min(n.min(), packet.min()) > 0.0 and place.min() >= 0.0
        if not (fine and np.all(noise[:, 2:][known] >= 1e-6) and np.all(np.isfinite(residual[:, :2]))):
            self.refuse(
                '`map` has a standard deviation, an exponent, a length or a place that is none',
                'amplitude_db >= 0, length > 0, n > 0, place_db >= 0, packet_db > 0, noise_db >= 1e-6',
            )
        points = residual[:, :2]
        try:
            return make_map(
                ids,
                p1,
                n,
                points,
                residual[:, 2:],
                np.where(known, noise[:, 2:], 1.0),
                amplitude,
                length,
                place,
                packet,
            )
        except (np.linalg.LinAlgError, MemoryError) as error:
            self.refuse(f'its `map` cannot be computed ({error})', 'amplitude_db and noise_db of similar size')

    def table(self, text: Any, width: int, name: str) -> Floats:
        rows: Sequence[list[str]] = [line.split() for line in text.splitlines()] if isinstance(text, str) else []
        if not 0 < len(rows) <= MOST_PLACES or any(len(row) != width for row in rows):
            self.refuse(
                f'`{name}` of `map` has {len(rows)} rows', f'1 to {MOST_PLACES} rows of {width} numbers, `-` for none'
            )
        try:
            values = np.array([[np.nan if cell == '-' else float(cell) for cell in row] for row in rows])
        except ValueError as error:
            self.refuse(f'`{name}` of `map`: {error}', f'rows of {width} numbers, `-` for none')
        most = np.where(np.arange(width) < 2, FURTHEST, 1e6)
        if np.any(np.abs(values) > most):  # NaN: none
            self.refuse(f'`{name}` of `map` holds infinite or absurd numbers', 'metres and decibels')
        return values


def _shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 100 else text[:100] + '...'

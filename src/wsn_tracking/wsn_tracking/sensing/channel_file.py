"""The text of a channel: YAML that people read and correct, `[value, standard deviation, 95 % low, 95 % high]`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import FURTHEST, Floats
from wsn_tracking.models.anchors import LIMITS as RADIO_LIMITS
from wsn_tracking.models.radio_map import RadioMap, make_map
from wsn_tracking.ros_yaml import parse
from wsn_tracking.sensing.channel import Body, Channel, PathLoss, Quantity, Ranging

FORMAT = 'wsn_tracking channel 1'
LIMITS: Mapping[str, tuple[float, float]] = {  # of values that a radio, or a body beside it, can have
    **RADIO_LIMITS,
    'sigma': (1e-9, 1e4),
    'loss': (-60.0, 60.0),
    'at_1_m': (-100.0, 100.0),
    'per_decade': (-100.0, 100.0),
}
MOST_PLACES = 5000  # a larger map would fill the memory before it served anybody
HEADER = """\
# Radios as `wsn-tracking calibrate` found them: for --channel of import, evaluate and replay, parameter `channel`.
# A number of a node is [value, standard deviation, lower, upper end of the 95 % confidence interval]; the value counts.
"""
PATH_LOSS = """
# Signal strength [dBm] at distance d [m]: p1_dbm - 10 n log10(d / 1 m); sigma_db [dB]: standard deviation of one packet
# about that. places: where the node was heard; readings: how often (0: not told).
"""
RANGING = """
# Range [m] at distance d [m]: scale d + bias; sigma [m]: standard deviation of one range about that.
"""
BODY = """
# What a body does to the node that it wears, in dB beside path loss. loss: all readings; los, nlos: nodes in front of
# it and behind it, at 1 m and per decade of distance; sigma_db: scatter about them; readings: in front, behind.
"""
MAP = """
# What the survey tells beyond path loss: a Gaussian process per node (Matern 3/2) about it, of standard deviation
# amplitude_db [dB] and correlation length [m]. nodes: [p1_dbm, n, place_db, packet_db]: path loss beside that field,
# standard deviations [dB] of fading from place to place and of packets at one place. Tables: x, y [m], then a column a
# node, `-` where it was not heard: signal strength minus that path loss, and with which standard deviation it counts.
"""


def channel_text(channel: Channel) -> str:
    """The file of a channel."""
    lines = [HEADER.rstrip(), f'format: {FORMAT}', 'origin:', *_origin(channel.origin)]
    if channel.path_loss is not None:
        lines += [PATH_LOSS.rstrip(), 'path_loss:', *_nodes(channel.ids, channel.path_loss)]
    if channel.ranging is not None:
        lines += [RANGING.rstrip(), 'ranging:', *_nodes(channel.ids, channel.ranging)]
    if channel.body is not None:
        lines += [BODY.rstrip(), 'body:', *_body_lines(channel.body)]
    if channel.radio_map is not None:
        lines += [MAP.rstrip(), 'map:', *_map_lines(channel.radio_map)]
    return '\n'.join(lines) + '\n'


def _origin(origin: Mapping[str, str]) -> Iterable[str]:
    for name, words in origin.items():
        quoted = ' '.join(words.split()).replace("'", "''")
        yield f"  {name}: '{quoted}'"


def _nodes(ids: NDArray[np.int64], radios: PathLoss | Ranging) -> Iterable[str]:
    for row, node in enumerate(ids.tolist()):
        cells = []
        for name, column in radios._asdict().items():
            if isinstance(column, Quantity):
                cells.append(f'{name}: {_cell(column, row)}')
            else:
                cells.append(f'{name}: {int(column[row])}')
        yield f'  {node}: {{{", ".join(cells)}}}'


def _body_lines(body: Body) -> Iterable[str]:
    yield f'  loss: {_cell(body.loss, 0)}'
    for name in ('los', 'nlos'):
        line = getattr(body, name)
        if line is not None:
            yield f'  {name}: {{at_1_m: {_cell(line, 0)}, per_decade: {_cell(line, 1)}}}'
    yield f'  sigma_db: {_number(body.sigma_db)}'
    yield f'  readings: [{body.readings[0]}, {body.readings[1]}]'


def _cell(quantity: Quantity, row: int) -> str:
    return f'[{", ".join(_number(float(part[row])) for part in quantity)}]'


def _map_lines(radio_map: RadioMap) -> Iterable[str]:
    yield f'  amplitude_db: {_number(radio_map.amplitude_db)}'
    yield f'  length: {_number(radio_map.length)}'
    yield '  nodes:'
    columns = [radio_map.p1_dbm, radio_map.n, radio_map.place_db, radio_map.packet_db]
    for node, values in zip(radio_map.ids.tolist(), np.stack(columns, axis=-1).tolist(), strict=True):
        yield f'    {node}: [{", ".join(map(_number, values))}]'
    for name in ('residual_db', 'noise_db'):
        yield f'  {name}: |'
        rows = np.concatenate([radio_map.points, getattr(radio_map, name)], axis=1)
        known = np.concatenate([np.ones((len(rows), 2), dtype=np.bool_), np.isfinite(radio_map.residual_db)], axis=1)
        for (x, y, *row), (_, _, *there) in zip(rows.tolist(), known.tolist(), strict=True):
            cells = [_number(cell) if k else '-' for cell, k in zip(row, there, strict=True)]
            yield '    ' + ' '.join([_coordinate(x), _coordinate(y), *cells])


def _number(value: float) -> str:
    """Short, and a number for every reader of YAML: with a point, the exponent with one as well."""
    text = f'{value:.6g}'
    mantissa, e, exponent = text.partition('e')
    if '.' not in mantissa and 'n' not in mantissa:
        mantissa += '.0'
    return mantissa + e + exponent


def _coordinate(value: float) -> str:
    """To the millimetre at least, also in the grid of a country."""
    return _number(value) if abs(value) < 1000.0 else f'{value:.3f}'


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
    """Checks every value; what is wrong is said with its place."""

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

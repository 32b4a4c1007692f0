"""The text of a channel: YAML that people read and correct, `[value, standard deviation, 95 % low, 95 % high]`."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from wsn_tracking.models.radio_map import RadioMap
from wsn_tracking.sensing.channel import Body, Channel, PathLoss, Quantity, Ranging

FORMAT = 'wsn_tracking channel 1'
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

"""A channel of three nodes, with a map and with ranges, and its file."""

from __future__ import annotations

import re

import numpy as np

from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.sensing.channel import Channel, Quantity, Ranging
from wsn_tracking.sensing.channel_file import save_channel
from wsn_tracking.sensing.channel_fit import fit_path_loss
from wsn_tracking.sensing.channel_text import channel_text
from wsn_tracking.sensing.survey import survey_of_places

IDS = [3, 7, 20]
POSITIONS = [[0.0, 0.0, 2.0], [8.0, 0.0, 2.0], [0.0, 8.0, 2.0]]


def quantity(*values):
    """Values with a deviation of 0.1 and an interval of 0.2 to both sides."""
    value = np.array(values, dtype=np.float64)
    return Quantity(value, np.full(value.size, 0.1), value - 0.2, value + 0.2)


def a_channel(map_too=True, ranging=True):
    """Fitted to readings of radios of -55 dBm and exponent 2 in a field of 3 dB."""
    rng = np.random.default_rng(0)
    anchors = make_anchors(IDS, POSITIONS, p1_dbm=-55.0, n=2.0)
    places = np.column_stack([rng.uniform(0.0, 8.0, (25, 2)), np.ones(25)])
    d = np.linalg.norm(places[:, None] - anchors.positions, axis=-1)
    y = -55.0 - 20.0 * np.log10(d) + 3.0 * np.sin(places[:, :1] + np.arange(3)) + rng.normal(0.0, 1.0, (25, 3))
    y[3, 1] = np.nan
    survey = survey_of_places(anchors, places, y, np.full(y.shape, 2.0), np.isfinite(y) * 9.0)
    loss, radio_map, _ = fit_path_loss(survey)
    counts = np.array([4, 5, 6])
    ranges = Ranging(quantity(0.1, -0.2, 0.0), quantity(1.0, 1.07, 0.99), quantity(0.3, 0.4, 0.5), counts, counts)
    origin = {'bag': "it's a: bag # {x}", 'until': '15 s'}
    return Channel(np.array(IDS), loss, ranges if ranging else None, radio_map if map_too else None, origin)


GOOD = channel_text(a_channel())


def changed(pattern, new, count=1):
    """The text of a good file in which `pattern` is replaced."""
    text, n = re.subn(pattern, new, GOOD, count=count, flags=re.DOTALL)
    assert n
    return text


def saved(folder, channel=None):
    """The path of its file."""
    path = folder / 'channel.yaml'
    save_channel(path, channel or a_channel())
    return str(path)

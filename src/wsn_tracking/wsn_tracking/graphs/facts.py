"""What every system is told of a field that no configuration was made for: how fast targets are, how far it reaches.

A configuration is for its own field: 14 m/s in one, 6 cm/s in another. What a feed tells of itself, the places of its
nodes, is enough for a start: targets that cross a field do so in the better part of a minute.
"""

from __future__ import annotations

import bisect
import math
from typing import NamedTuple

import numpy as np

from wsn_tracking.graphs.parts import Source, numbers_of
from wsn_tracking.models.anchors import Anchors, Floats
from wsn_tracking.models.graph import adjacency, diameter, is_connected
from wsn_tracking.parameters import Values

CROSSED_S = 40.0  # the time in which a target goes from one corner to the other
TAILS = 4.0  # degrees of freedom: fading has heavy tails, and where it has none, they cost nearly nothing
STEADY_S = 3.0  # S = speed^2 / that: so long it keeps its velocity
SPARE = 1.2  # of the radius that just connects all nodes
Box = tuple[float, float, float, float]


class Facts(NamedTuple):
    """What is known of targets and radios of a field: the same for every system."""

    speed: float  # [m/s] of a target that moves
    spectral_density: float  # [m^2/s^3] of the white acceleration that stands for its manoeuvres
    turn: float  # [deg/s] how fast it turns
    radius: float  # [m] of the links between nodes
    rounds: int  # that reach from any node to any other
    range_std: float = 0.1  # [m] of a range that tells none
    sigma_db: float = 0.0  # of a signal strength for whoever knows no bodies; 0: as it is told
    dof: float = 0.0  # of heavy tails; 0: none
    person: bool = False  # who wears the node: a body shades it


def facts_of(source: Source, anchors: Anchors) -> Facts:
    """A guess, from the extent of the field and the places of its nodes."""
    x_min, y_min, x_max, y_max = box_of(source, anchors)
    speed = max(math.hypot(x_max - x_min, y_max - y_min), 1.0) / CROSSED_S
    radius = SPARE * connecting_radius(anchors.positions)
    rounds = max(diameter(adjacency(anchors.positions, radius)), 1)
    dof = TAILS if source.entry_level == 'rssi' else 0.0
    return Facts(speed, speed**2 / STEADY_S, 10.0, radius, rounds, dof=dof)


def box_of(source: Source, anchors: Anchors) -> Box:
    """x_min, y_min, x_max, y_max [m] of the area that the feed tells, else round its nodes."""
    corners = np.reshape(source.area, (-1, 2)) if source.area else anchors.positions[:, :2]
    (x_min, y_min), (x_max, y_max) = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
    return x_min, y_min, x_max, y_max


def connecting_radius(positions: Floats) -> float:
    """The least radius [m] at which every node of positions (N, 3) reaches every other; 1 where there is no other."""
    d = np.linalg.norm(positions[:, None] - positions[None], axis=-1)
    lengths = np.unique(d[d > 0.0])
    if lengths.size == 0:
        return 1.0
    # a link as long as the radius counts, whatever its square rounds to
    radii = lengths * (1.0 + 1e-9)
    return float(radii[bisect.bisect_left(radii, True, key=lambda r: bool(is_connected(adjacency(positions, r))))])


def told(system: str, source: Source, anchors: Anchors, facts: Facts) -> Values:
    """The parameters of a system that follow from the facts alone."""
    S = facts.spectral_density
    period = numbers_of(source, period=('period', 1.0)).get('period', 1.0)
    if system == 'random_q':
        return {
            'trigger.kind': 'always',  # thresholds are a field's own: those of another may let nothing through
            'noise.kind': 'acceleration',
            'noise.spectral_density': S,
            'update.range_std': facts.range_std,
            'start.speed': facts.speed,
            'robust.dof': facts.dof,
        }
    if system == 'consensus':
        x_min, y_min, x_max, y_max = box_of(source, anchors)
        width, height = max(x_max - x_min, 1.0), max(y_max - y_min, 1.0)
        return {
            'rounds': facts.rounds,
            'radius': facts.radius,
            'spectral_density': S,
            'arrival.r_max': math.hypot(width, height),
            'arrival.repair_rate': 0.9,
            'observation.range_std': facts.range_std,
            'prior.mean': [0.5 * (x_min + x_max), 0.5 * (y_min + y_max), 0.0, 0.0],
            'prior.std': [0.3 * width, 0.3 * height, facts.speed, facts.speed],
        }
    if system == 'human':
        walks = {'motion.slowest': 0.5 * facts.speed, 'motion.fastest': 1.5 * facts.speed}
        noise = {'motion.speed_noise': 0.25 * facts.speed, 'motion.position_noise': 0.1 * facts.speed}
        body = {} if facts.person else {'signal.kind': 'single', 'signal.least_distance': 0.01}
        return {**walks, **noise, **body, 'signal.dof': facts.dof}
    if system == 'hybrid':
        return {
            'period': period,
            'range_std': facts.range_std,
            'motion.spectral_density': S,
            'models.spectral_density': S,
            'start.window': max(0.5, 3.0 * period),
            'start.velocity_std': facts.speed,
            'robust.dof': facts.dof,
        }
    return {
        'turn.acceleration_std': math.sqrt(S / period),
        'turn.turn_std': facts.turn,
        'update.range_std': facts.range_std,
        'start.speed': facts.speed,
        'start.turn': facts.turn,
    }

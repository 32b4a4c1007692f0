"""Who may enter whom: the rooms of the package and the imports between them, drawn from the sources."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path
from typing import NamedTuple

import pytest

PACKAGE = 'wsn_tracking'
ROOT = Path(__file__).parents[1] / PACKAGE

LEAVES = {'errors', 'parameters', 'files', 'ros_yaml', 'streams', 'lifeline'}  # text, files, errors: for everyone

# A room and those that it may enter; whom these may enter, it may enter as well.
ROOMS = {
    'models': (),
    'filters': ('models',),
    'fusion': ('filters',),
    'sensing': ('models',),
    'trackers': ('fusion', 'sensing'),
    'bags': ('sensing',),
    'simulation': ('sensing',),
    'evaluation': ('trackers', 'bags', 'simulation'),
    'viewing': ('evaluation',),
    'zstack': (),
    # what stands above the rooms, for nodes and commands
    'node_parameters': ('trackers', 'zstack', 'driven_air'),
    'configuration': ('node_parameters',),
    'graphs': ('configuration', 'bags', 'simulation'),
    'processes': ('graphs',),
    'launching': ('processes',),
    'offline': ('graphs', 'evaluation'),
    'surveys': ('evaluation',),
    'driven_air': ('simulation', 'zstack'),
    'bridging': ('sensing', 'zstack'),
    'airwaves': ('graphs', 'zstack'),
    'sink_thread': ('zstack',),  # the thread around a simulated sink; zstack holds none but the session's
    'studies': ('offline', 'surveys', 'airwaves', 'processes', 'sink_thread'),
    'reproduction': ('studies',),
    'follower': ('studies',),
    'benchmarks': ('studies',),
    'documentation': ('node_parameters', 'bags'),
    'nodes': ('viewing', 'bridging', 'airwaves', 'offline'),
    'commands': (
        'viewing',
        'airwaves',
        'offline',
        'processes',
        'surveys',
        'documentation',
        'benchmarks',
        'reproduction',
    ),
    'cli': ('commands',),
}
# Single modules of a room that others may enter all the same, and why.
DOORS = {('bags', 'trackers.estimate')}  # an estimate is a value, which bags hold; it knows models alone
LAZY_DOORS = {('commands', 'nodes')}  # `watch` is a node; no other command may need ROS

ROS = ('rclpy', 'rcl_interfaces', 'builtin_interfaces', 'tf2_ros', 'ament_index_python', 'rosidl_runtime_py')
LAZY = {'scipy', 'matplotlib', 'stonesoup', 'joblib', 'distributed'}  # slow: never while a module is imported
ONLY_IN = {'launch': 'launching', 'launch_ros': 'launching'}


class Import(NamedTuple):
    """One imported module, dotted, and whether it is imported when its module is."""

    name: str
    at_start: bool


def imports(module: str, source: str) -> Iterator[Import]:
    """Every import of a module, also those within functions and those for types alone."""
    tree = ast.parse(source)
    at_start = {id(node) for node in _at_start(tree)}
    package = module.split('.')
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield Import(alias.name, id(node) in at_start)
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) - node.level] if node.level else []
            base = [*above, *filter(None, [node.module])]
            for alias in node.names:
                yield Import('.'.join([*base, alias.name]), id(node) in at_start)


def _at_start(node: ast.AST) -> Iterator[ast.AST]:
    """What runs when a module is imported: all but the bodies of functions and what is for types alone."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)):
            continue
        if isinstance(child, ast.If) and 'TYPE_CHECKING' in ast.dump(child.test):
            continue
        yield child
        yield from _at_start(child)


def reach(room: str) -> set[str]:
    """The rooms that a room may enter."""
    allowed = set(ROOMS[room])
    for entered in ROOMS[room]:
        allowed |= reach(entered)
    return allowed


def violations(module: str, source: str) -> list[str]:
    """What a module may not import; `module` is its dotted name, e.g. wsn_tracking.models.radio."""
    room = module.split('.')[1] if '.' in module else ''
    if room and room not in {*ROOMS, *LEAVES}:
        return [f'{module}: room `{room}` is not in the plan']
    allowed = {*LEAVES, *(reach(room) if room in ROOMS else ()), room}
    found = []
    for name, at_start in imports(module, source):
        top, _, inside = name.partition('.')
        if top == PACKAGE:
            entered = inside.partition('.')[0]
            opened = any(room == r and f'{inside}.'.startswith(f'{door}.') for r, door in DOORS)
            opened = opened or (not at_start and (room, entered) in LAZY_DOORS)
            wrong = bool(entered) and entered not in allowed and not opened
        elif top in ROS or top.endswith('_msgs'):
            wrong = room != 'nodes'
        elif top in ONLY_IN:
            wrong = room != ONLY_IN[top]
        else:
            wrong = (top in LAZY and at_start) or (top == 'numpy' and room == 'zstack')
        if wrong:
            found.append(f'{module} may not import {name}')
    return found


@cache
def modules() -> dict[str, str]:
    """Sources by dotted name."""
    sources = {}
    for path in sorted(ROOT.rglob('*.py')):
        parts = path.relative_to(ROOT.parent).with_suffix('').parts
        sources['.'.join(parts[:-1] if parts[-1] == '__init__' else parts)] = path.read_text('utf-8')
    return sources


@pytest.mark.parametrize('module', sorted(modules()))
def test_no_arrow_that_the_plan_forbids(module):
    assert violations(module, modules()[module]) == []


def test_every_room_of_the_plan_exists():
    """A room that is renamed must be renamed here."""
    assert {*ROOMS, *LEAVES} == {name.split('.')[1] for name in modules() if '.' in name}


def test_the_plan_has_no_circle():
    assert all(room not in reach(room) for room in ROOMS)


def test_no_modules_import_each_other_in_a_circle():
    """Not even from within a function: a module is understood by those below it."""

    def module_of(name):
        while name and name not in modules():
            name = name.rpartition('.')[0]
        return name

    graph = {
        module: {module_of(name) for name, _ in imports(module, source)} - {module, PACKAGE, ''}
        for module, source in modules().items()
    }
    TopologicalSorter(graph).prepare()  # raises CycleError, which names them


FORBIDDEN = [
    ('models.radio', 'from wsn_tracking.filters import srckf'),
    ('models.radio', 'from wsn_tracking.sensing.values import Rssi'),
    ('models.radio', 'from wsn_tracking import configuration'),
    ('filters.srckf', 'import wsn_tracking.fusion.simplex'),
    ('filters.srckf', 'from wsn_tracking.sensing import values'),
    ('fusion.simplex', 'from wsn_tracking.trackers.gate import FusionGate'),
    ('fusion.simplex', 'from wsn_tracking.sensing import values'),
    ('sensing.stage', 'from wsn_tracking.filters import srckf'),
    ('sensing.stage', 'from wsn_tracking.trackers.estimate import Estimate'),
    ('sensing.stage', 'from wsn_tracking.bags.read import read'),
    ('trackers.gate', 'from wsn_tracking.bags.read import read'),
    ('trackers.gate', 'from wsn_tracking.evaluation.score import score'),
    ('trackers.gate', 'from wsn_tracking.simulation import world'),
    ('bags.read', 'from wsn_tracking.trackers.gate import FusionGate'),
    ('bags.read', 'from wsn_tracking.trackers import gate'),
    ('bags.read', 'from wsn_tracking.trackers import *'),
    ('bags.read', 'from wsn_tracking.trackers.estimates import x'),
    ('bags.read', 'from wsn_tracking.simulation import record'),
    ('bags.read', 'from wsn_tracking.filters import srckf'),
    ('simulation.world', 'from wsn_tracking.filters import srckf'),
    ('simulation.world', 'from wsn_tracking.bags.write import BagWriter'),
    ('evaluation.run', 'from wsn_tracking.graphs import Plan'),
    ('evaluation.run', 'from wsn_tracking.zstack import frames'),
    ('evaluation.run', 'from wsn_tracking.nodes.window import Window'),
    ('evaluation.run', 'from wsn_tracking.studies.intervals import mean_of'),
    ('nodes.base', 'from wsn_tracking.studies import live'),
    ('zstack.frames', 'from wsn_tracking.models import anchors'),
    ('zstack.frames', 'from wsn_tracking.sensing.values import Rssi'),
    ('zstack.frames', 'import numpy as np'),
    ('zstack.frames', 'def f():\n    import numpy'),
    ('zstack.frames', 'from numpy.linalg import qr'),
    ('configuration', 'from wsn_tracking.graphs import Plan'),
    ('configuration', 'from wsn_tracking.evaluation.run import Run'),
    ('graphs', 'from wsn_tracking.processes import run_graph'),
    ('graphs', 'from wsn_tracking.evaluation.run import Run'),
    ('graphs', 'from wsn_tracking.nodes import base'),
    ('processes', 'from wsn_tracking.cli import main'),
    ('offline', 'from wsn_tracking.commands import base'),
    ('errors', 'from wsn_tracking.models import anchors'),
    ('parameters', 'from wsn_tracking.configuration import Values'),
    ('nodes.base', 'from wsn_tracking.cli import main'),
    ('nodes.base', 'from wsn_tracking.commands import base'),
    ('commands.replay', 'from wsn_tracking.cli import main'),
    ('commands.watch', 'from wsn_tracking.nodes.watcher import watching'),
    ('cli', 'from wsn_tracking.nodes import base'),
    ('', 'from wsn_tracking.models import anchors'),
    ('attic.old', 'import math'),
    # within functions, classes, conditions, for types alone, relative
    ('models.radio', 'def f():\n    from wsn_tracking.filters import srckf'),
    ('models.radio', 'class A:\n    def f(self):\n        import wsn_tracking.sensing.stage'),
    ('models.radio', 'try:\n    import wsn_tracking.sensing.stage\nexcept ImportError:\n    pass'),
    ('models.radio', 'if TYPE_CHECKING:\n    from wsn_tracking.filters.belief import Belief'),
    ('models.radio', 'from ..filters import srckf'),
    ('models.radio', 'from .. import filters'),
    # ROS
    ('models.radio', 'import rclpy'),
    ('commands.watch', 'def f():\n    from rclpy.node import Node'),
    ('bags.read', 'from wsn_tracking_msgs import msg'),
    ('evaluation.run', 'from nav_msgs.msg import Odometry'),
    ('graphs', 'from builtin_interfaces.msg import Time'),
    ('nodes.base', 'def f():\n    from launch import LaunchDescription'),
    ('graphs', 'import launch_ros.actions'),
    # slow packages while a module is imported
    ('sensing.channel', 'import scipy'),
    ('filters.srckf', 'from scipy.linalg import qr'),
    ('evaluation.plots', 'import matplotlib.pyplot as plt'),
    ('evaluation.plots', 'class A:\n    import matplotlib'),
    ('nodes.base', 'if True:\n    import scipy.linalg'),
    ('trackers.gate', 'from stonesoup.types.state import State'),
]


@pytest.mark.parametrize(('module', 'source'), FORBIDDEN)
def test_a_forbidden_import_is_found(module, source):
    name = f'{PACKAGE}.{module}'.rstrip('.')
    (found,) = violations(name, f'"""Words."""\nimport math\n{source}\n')
    assert found.startswith(name)


ALLOWED = [
    ('models.radio', 'from wsn_tracking.models.anchors import Anchors\nfrom wsn_tracking.errors import TrackingError'),
    ('models.radio', 'from . import anchors\nfrom .anchors import Anchors\nimport numpy'),
    ('fusion.simplex', 'from wsn_tracking.filters.belief import Belief\nfrom wsn_tracking.models import anchors'),
    ('trackers.gate', 'from wsn_tracking import fusion, filters, models, sensing, parameters'),
    ('bags.read', 'from wsn_tracking.trackers.estimate import Estimate\nfrom wsn_tracking.trackers import estimate'),
    ('evaluation.run', 'from wsn_tracking import trackers, bags, simulation, sensing, filters, fusion, models'),
    ('nodes.base', 'import rclpy\nfrom nav_msgs.msg import Odometry\nfrom wsn_tracking import zstack, graphs, offline'),
    ('commands.watch', 'def f():\n    from wsn_tracking.nodes.watcher import watching'),
    ('sensing.channel', 'def f():\n    from scipy.optimize import minimize'),
    ('evaluation.plots', 'if TYPE_CHECKING:\n    from matplotlib.figure import Figure'),
    ('launching', 'def f():\n    from launch import LaunchDescription'),
    ('', 'import math'),
]


@pytest.mark.parametrize(('module', 'source'), ALLOWED)
def test_an_allowed_import_is_not(module, source):
    assert violations(f'{PACKAGE}.{module}'.rstrip('.'), source) == []


def test_what_is_slow_or_ros_is_not_imported_by_detours():
    """The command line begins, and a node's room below `nodes` is imported, without any of it."""
    names = [f'{PACKAGE}.{name}' for name in ('cli', 'graphs', 'offline', 'trackers.estimator', 'evaluation.score')]
    slow = (*sorted(LAZY), 'rclpy', 'wsn_tracking_msgs')
    code = f'import sys, {", ".join(names)}\nprint([name for name in {slow} if name in sys.modules])'
    ended = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True, check=True)
    assert ended.stdout == '[]\n'

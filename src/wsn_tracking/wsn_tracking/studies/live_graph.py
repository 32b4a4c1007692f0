"""Graphs as processes, undisturbed by others on the network, and without their words."""

from __future__ import annotations

import contextlib
import io
import os

from wsn_tracking import graphs
from wsn_tracking.processes import run_graph


def alone() -> None:
    """What is run from here sees nodes of this host alone, in a domain likely nobody else's; what is set stays."""
    os.environ.setdefault('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    os.environ.setdefault('ROS_DOMAIN_ID', str(1 + os.getpid() % 99))


def quietly(graph: tuple[graphs.Process, ...], last: list[str]) -> int:
    """Run a graph whose words nobody wants; the exit status."""
    with contextlib.redirect_stderr(io.StringIO()):
        return run_graph(graph, last)

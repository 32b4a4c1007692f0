"""`wsn-tracking info`."""

from __future__ import annotations

import argparse

from wsn_tracking.commands.base import Commands, add_bag, add_command


def add(commands: Commands) -> None:
    """Describe the command."""
    add_bag(add_command(commands, 'info', _do, 'say what a bag holds', 'bags/a_loop'))


def _do(options: argparse.Namespace) -> int:
    from wsn_tracking.bags.info import describe
    from wsn_tracking.bags.read import read

    print(describe(read(options.bag, options.namespace)))
    return 0

"""`wsn-tracking import`."""

from __future__ import annotations

import argparse

from wsn_tracking.commands.base import Commands, add_command


def add(commands: Commands) -> None:
    """Describe the command."""
    command = add_command(
        commands,
        'import',
        _do,
        'turn a public recording into bags',
        'danis Position-Annotated-BLE-RSSI-Dataset -o danis',
    )
    command.add_argument('kind', choices=['danis'], help='which recording (docs/datasets.md)')
    command.add_argument('source', help='folder of the recording')
    command.add_argument('-o', '--output', required=True, metavar='BAGS', help='folder for the bags')


def _do(options: argparse.Namespace) -> int:
    from wsn_tracking.bags.danis import import_danis

    for path in import_danis(options.source, options.output):
        print(path)
    return 0

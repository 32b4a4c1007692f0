"""`wsn-tracking import`."""

from __future__ import annotations

import argparse

from wsn_tracking.bags.importing import KINDS
from wsn_tracking.commands.base import Commands, add_command


def add(commands: Commands) -> None:
    """Describe the command."""
    command = add_command(
        commands,
        'import',
        _do,
        'turn a public recording into bags',
        'danis Position-Annotated-BLE-RSSI-Dataset -o danis',
        'lias Planar_Dataset/Dynamic/UWB_dynamic_exp_mid.csv --rate 10 -o lias_mid',
        'plaza gtsam/examples/Data/Plaza2_.mat --channel plaza.yaml -o plaza2',
    )
    command.add_argument('kind', choices=KINDS, help='which recording (docs/datasets.md)')
    command.add_argument('source', metavar='SRC', help='folder of the recording; of several, the file of one')
    command.add_argument('--rate', type=hertz, metavar='HZ', help='lias: epochs per second (default: 10)')
    command.add_argument('--channel', metavar='FILE', help='calibration whose radios replace those of the recording')
    command.add_argument(
        '-o', '--output', required=True, metavar='BAG', help='bag to write; danis: folder for a bag a track'
    )


def hertz(text: str) -> float:
    """A rate."""
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0.01 <= value <= 1000.0:
        raise argparse.ArgumentTypeError(f'{text!r} is no rate: expected 0.01 to 1000 Hz')
    return value


def _do(options: argparse.Namespace) -> int:
    from wsn_tracking.bags.importing.run import import_set

    for path in import_set(options.kind, options.source, options.output, options.rate, options.channel):
        print(path)
    return 0

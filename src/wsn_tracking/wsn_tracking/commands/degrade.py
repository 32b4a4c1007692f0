"""`wsn-tracking degrade`."""

from __future__ import annotations

import argparse

from wsn_tracking.commands.base import Commands, add_bag, add_command, seed
from wsn_tracking.files import check_new_folder
from wsn_tracking.models.links import Loss


def add(commands: Commands) -> None:
    """Describe the command."""
    command = add_command(
        commands,
        'degrade',
        _do,
        'write a bag from which packets got lost',
        'lias_mid --loss 0.5 -o half',
        'lias_mid --loss 0.5 --bursts 5 --seed 3 -o bursts',
        'bags/a_loop --loss 0.3 --round -o rounds',
    )
    add_bag(command)
    command.add_argument('--loss', type=share, required=True, metavar='P', help='share that is lost, 0 to 1')
    command.add_argument(
        '--bursts', type=length, default=0.0, metavar='EPOCHS', help='mean length of a loss (default: as by chance)'
    )
    command.add_argument('--round', action='store_true', help='lose whole epochs, not single links')
    command.add_argument('--seed', type=seed, default=0, help='of the losses (default: 0)')
    command.add_argument('-o', '--output', required=True, metavar='BAG', help='folder to write; it must not exist')


def share(text: str) -> float:
    """A share."""
    return _number(text, 0.0, 1.0, 'a share from 0 to 1')


def length(text: str) -> float:
    """A mean number of epochs."""
    return _number(text, 1.0, 1e6, 'a number of epochs, 1 or more')


def _number(text: str, low: float, high: float, expected: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = low - 1.0
    if not low <= value <= high:
        raise argparse.ArgumentTypeError(f'{text!r}: expected {expected}')
    return value


def _do(options: argparse.Namespace) -> int:
    from wsn_tracking.bags.derived import MEASUREMENTS
    from wsn_tracking.bags.epochs import with_epoch_ends
    from wsn_tracking.bags.read import read
    from wsn_tracking.bags.save import save
    from wsn_tracking.bags.thin import thin

    check_new_folder(options.output)
    whole = with_epoch_ends(read(options.bag, options.namespace))
    thinned = thin(whole, Loss(options.loss, options.bursts, options.round), options.seed)
    save(options.output, thinned)
    before, after = (sum(isinstance(m, MEASUREMENTS) for m in r.messages) for r in (whole, thinned))
    print(f'{options.output}: {after} of {before} readings are left')
    return 0

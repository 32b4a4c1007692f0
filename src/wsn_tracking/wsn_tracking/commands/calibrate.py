"""`wsn-tracking calibrate`."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from wsn_tracking.commands.base import Commands, add_command, seconds

if TYPE_CHECKING:
    from wsn_tracking.sensing.channel import Channel, Quantity

TITLES = {'p1_dbm': 'P1 dBm', 'n': 'n', 'sigma_db': 'sigma dB', 'bias': 'bias m', 'scale': 'scale', 'sigma': 'sigma m'}


def add(commands: Commands) -> None:
    """Describe the command."""
    command = add_command(
        commands,
        'calibrate',
        _do,
        'find the radio of every node, from a survey or from a bag with truth',
        'Position-Annotated-BLE-RSSI-Dataset --map -o danis.yaml',
        'lias_mid --until 15 -o lias.yaml',
    )
    command.add_argument('source', metavar='SRC|BAG', help='folder of a survey (danis, kolakowski), or bag with truth')
    command.add_argument('-o', '--output', required=True, metavar='FILE', help='channel file (YAML); replaced if there')
    command.add_argument('--until', type=seconds, metavar='S', help='use only this much from the start of the bag')
    command.add_argument('--map', action='store_true', help='signal strengths: a radio map as well')
    command.add_argument('--namespace', help='namespace in the bag, where it holds several')


def _do(options: argparse.Namespace) -> int:
    from wsn_tracking.errors import TrackingError
    from wsn_tracking.sensing.channel import Channel, save_channel
    from wsn_tracking.sensing.channel_fit import fit_path_loss, fit_ranging
    from wsn_tracking.surveys import open_survey

    found = open_survey(options.source, options.until, options.namespace)
    origin = found.origin
    if found.ranges:
        if options.map:
            raise TrackingError(f'{options.source} holds ranges, a map is of signal strengths: leave out --map')
        channel = Channel(found.survey.ids, None, fit_ranging(found.survey), None, origin)
    else:
        loss, radio_map, told = fit_path_loss(found.survey)
        channel = Channel(found.survey.ids, loss, None, radio_map if options.map else None, {**origin, **told})
    save_channel(options.output, channel)
    print(f'{options.output}: {", ".join(f"{name} {words}" for name, words in channel.origin.items())}')
    _print_table(channel)
    return 0


def _print_table(channel: Channel) -> None:
    """A line a node: value and half of its 95 % interval."""
    found = channel.path_loss or channel.ranging
    assert found is not None
    columns: list[tuple[str, Quantity]] = [(TITLES[k], v) for k, v in found._asdict().items() if k in TITLES]
    print('node  ' + ''.join(f'{title:>18}' for title, _ in columns) + '  places  readings')
    for row, node in enumerate(channel.ids.tolist()):
        cells = [f'{q.value[row]:9.3f} ± {0.5 * (q.high[row] - q.low[row]):6.3f}' for _, q in columns]
        print(f'{node:<6}{"".join(f"{cell:>18}" for cell in cells)}{found.places[row]:8d}{found.readings[row]:10d}')

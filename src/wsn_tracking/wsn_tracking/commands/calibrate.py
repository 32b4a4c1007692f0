"""`wsn-tracking calibrate`."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING

from wsn_tracking.commands.base import Commands, add_command, seconds

if TYPE_CHECKING:
    from wsn_tracking.sensing.channel import Channel, Quantity

OPEN_DB = 20.0  # half of an interval of P1 from which on a radio is hardly known: at n = 2, a decade of distance
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
        'bags/c_walk --body -o worn.yaml',
    )
    command.add_argument('source', metavar='SRC|BAG', help='folder of a survey (danis, kolakowski), or bag with truth')
    command.add_argument('-o', '--output', required=True, metavar='FILE', help='channel file (YAML); replaced if there')
    command.add_argument('--until', type=seconds, metavar='S', help='use only this much from the start of the bag')
    command.add_argument('--map', action='store_true', help='signal strengths: a radio map as well')
    command.add_argument(
        '--body',
        action='store_true',
        help='signal strengths of a node that is worn: what the body does, in front and behind, by truth and headings',
    )
    command.add_argument(
        '--channel',
        metavar='FILE',
        help='with --body: radios that are known, e.g. of a survey; else from the bag itself',
    )
    command.add_argument('--namespace', help='namespace in the bag, where it holds several')


def _do(options: argparse.Namespace) -> int:
    from wsn_tracking.errors import TrackingError
    from wsn_tracking.sensing.channel import Channel
    from wsn_tracking.sensing.channel_file import save_channel
    from wsn_tracking.sensing.channel_fit import fit_path_loss, fit_ranging
    from wsn_tracking.surveys import open_survey

    if options.body:
        return _of_body(options)
    if options.channel:
        raise TrackingError('--channel gives the radios that --body is beside: it is of no use without --body')
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
    _warn_of_open_radios(channel)
    return 0


def _of_body(options: argparse.Namespace) -> int:
    from wsn_tracking.errors import TrackingError
    from wsn_tracking.sensing.body_fit import fit_worn
    from wsn_tracking.sensing.channel_file import load_channel, save_channel
    from wsn_tracking.surveys import open_walk

    if options.map:
        raise TrackingError('--map is of a survey, --body of a walk: make the map first, and give it by --channel')
    walk = open_walk(options.source, options.until, options.namespace)
    known = load_channel(options.channel) if options.channel else None
    channel = fit_worn(walk.readings, walk.facing, walk.anchors, known)
    origin = {**channel.origin, **{f'body_{name}': words for name, words in walk.origin.items()}}
    save_channel(options.output, channel._replace(origin=origin))
    print(f'{options.output}: {", ".join(f"{name} {words}" for name, words in origin.items())}')
    if known is None:
        _print_table(channel)
    _print_body(channel)
    if known is None:
        _warn_of_open_radios(channel)
    return 0


def _print_body(channel: Channel) -> None:
    """What the body does beside path loss, with halves of 95 % intervals."""
    body = channel.body
    assert body is not None
    print(f'body    readings {body.readings[0]} + {body.readings[1]}, scatter {body.sigma_db:.2f} dB')
    for name, line in (('loss', body.loss), ('los', body.los), ('nlos', body.nlos)):
        if line is not None:
            cells = [
                f'{v:7.2f} ± {0.5 * (h - l):5.2f}' for v, l, h in zip(line.value, line.low, line.high, strict=True)
            ]
            print(f'{name:<8}{" dB at 1 m, ".join(cells)} dB{" per decade" if len(cells) > 1 else ""}')


def _print_table(channel: Channel) -> None:
    """A line a node: value and half of its 95 % interval."""
    found = channel.path_loss or channel.ranging
    assert found is not None
    columns: list[tuple[str, Quantity]] = [(TITLES[k], v) for k, v in found._asdict().items() if k in TITLES]
    print('node  ' + ''.join(f'{title:>18}' for title, _ in columns) + '  places  readings')
    for row, node in enumerate(channel.ids.tolist()):
        cells = [f'{q.value[row]:9.3f} ± {0.5 * (q.high[row] - q.low[row]):6.3f}' for _, q in columns]
        print(f'{node:<6}{"".join(f"{cell:>18}" for cell in cells)}{found.places[row]:8d}{found.readings[row]:10d}')


def _warn_of_open_radios(channel: Channel) -> None:
    """One line about the nodes whose path loss is hardly known: a tracker believes it all the same."""
    if channel.path_loss is None:
        return
    p1 = channel.path_loss.p1_dbm
    nodes = channel.ids[0.5 * (p1.high - p1.low) > OPEN_DB].tolist()
    if nodes:
        print(
            f'P1 of nodes {", ".join(map(str, nodes))} is open by more than {OPEN_DB:.0f} dB, and a tracker takes the '
            'value for true: better the radios of a survey, or of a longer walk past these nodes, than this file',
            file=sys.stderr,
        )

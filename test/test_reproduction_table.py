"""docs/reproduction.md tells of the comparison of all systems what its table holds."""

import pytest

from quotes import quoted, told
from reproduced import KEPT, PAGE, ends

(TABLE,) = KEPT['tables']
SYSTEMS = ('A', 'B', 'C', 'D', 'E', 'centre')
ONE_BY_ONE = ('labyrinth', 'plaza2')  # one node is heard in an epoch


def cells(recordings, column, systems=SYSTEMS):
    """Numbers of the table."""
    place = TABLE['columns'].index(column)
    found = {(row[0], row[1]): row[place] for row in TABLE['rows']}
    return [found[recording, system] for recording in recordings for system in systems]


def rmse(recording, *systems):
    return cells([recording], 'RMSE [m]', systems or SYSTEMS)


def halved(recordings):
    """How many times as large errors are with half of the packets, by recording and system."""
    pairs = [(recording, system) for recording in recordings for system in SYSTEMS]
    values = zip(cells(recordings, '50% lost'), cells(recordings, 'RMSE [m]'), strict=True)
    return dict(zip(pairs, (lossy / whole for lossy, whole in values), strict=True))


def elsewhere():
    return halved([name for name in dict.fromkeys(row[0] for row in TABLE['rows']) if name not in ONE_BY_ONE])


BEHIND = ('a_loop', 'A')  # A behind its trigger
RANGED = {'lias': SYSTEMS, 'labyrinth': SYSTEMS, 'plaza2': ('A', 'B', 'D', 'centre')}
COMPARED = [
    (
        'the systems are within @ % of each other: @ to @ m, @ to @ m, @ to @ m',
        lambda: [
            100.0 * (max(max(rmse(n, *some)) / min(rmse(n, *some)) for n, some in RANGED.items()) - 1.0),
            *(end for name, some in RANGED.items() for end in ends(rmse(name, *some))),
        ],
    ),
    (
        '(B: @ to @ times those of a centre on these)',
        lambda: ends([b / c for b, c in (cells([n], 'messages', ('B', 'centre')) for n in RANGED)]),
    ),
    ('track: @ m (C) against @ m and more', lambda: [*rmse('c_walk', 'C'), min(rmse('c_walk', 'A', 'B', 'D', 'E'))]),
    ('most accurate, too: @ and @ m', lambda: [*rmse('danis', 'C'), *rmse('kolakowski', 'C')]),
    ('lost makes errors @ to @ times as large where one node', lambda: ends(halved(ONE_BY_ONE).values())),
    (
        'at most @ times elsewhere, but for A behind its trigger on `a_loop` (@ times)',
        lambda: [max(v for key, v in elsewhere().items() if key != BEHIND), elsewhere()[BEHIND]],
    ),
    (
        'B, C and D have @ to @ m, A, the centre and E @ m and more',
        lambda: [*ends(rmse('mrclam', 'B', 'C', 'D')), min(rmse('mrclam', 'A', 'centre', 'E'))],
    ),
    ('persons (NEES @ and more', lambda: [min(cells(['danis', 'c_walk'], 'NEES (of 2)', ['D']))]),
    ('for some of the time (@ m)', lambda: rmse('plaza2', 'C')),
    ('no filter can tell (NEES @ and more)', lambda: [min(cells(['zignav'], 'NEES (of 2)'))]),
]


@pytest.mark.parametrize(('words', 'values'), COMPARED)
def test_what_is_told_of_the_comparison_follows_from_its_table(words, values):
    quoted(*zip(told(words, PAGE), values(), strict=True))


def test_particles_are_the_most_accurate_on_real_signal_strengths():
    for name in ('danis', 'kolakowski'):
        assert rmse(name, 'C')[0] == min(rmse(name))


def test_the_place_of_each_epoch_is_better_than_any_where_no_radio_is_calibrated():
    assert rmse('zignav', 'fix')[0] < min(rmse('zignav'))


def test_milliseconds_are_told_as_they_were_measured():
    """They differ from run to run: by half at most."""
    cpu = {(row[0], row[1]): value for row, value in zip(TABLE['rows'], TABLE['measured']['CPU [ms]'], strict=True)}
    least, most = map(float, told('milliseconds (B: @ to @ times)', PAGE))
    times = [cpu[name, 'B'] / cpu[name, 'centre'] for name in RANGED]
    assert least / 1.5 <= min(times) <= max(times) <= 1.5 * most

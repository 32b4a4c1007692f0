"""Statements on all systems side by side, on the simulated recordings."""

from __future__ import annotations

from collections.abc import Sequence

from wsn_tracking.models.anchors import Floats
from wsn_tracking.reproduction.claims import BEYOND, Claim, Figure, Samples
from wsn_tracking.reproduction.cross import SIMULATED
from wsn_tracking.reproduction.quantities import mean, ratio, root_mean

FIVE = ('A', 'B', 'C', 'D', 'E')
SHOWN = ('centre', *FIVE)


def squares(s: Samples, name: str, rate: float = 0.0) -> Floats:
    """Mean squared error of each run [m^2]."""
    return s[f'{name} {rate:g}: squares']


def filtering(s: Samples) -> Sequence[Figure]:
    """The five and the centre against least squares of each epoch, and against the centre."""
    fix, centre = squares(s, 'fix'), squares(s, 'centre')
    return [
        *(ratio(f'RMSE, {n} / fix', squares(s, n), fix, True, shape=(None, 0.6)) for n in SHOWN),
        *(ratio(f'RMSE, {n} / centre', squares(s, n), centre, True, shape=(None, 1.25)) for n in ('B', 'C', 'D', 'E')),
        ratio('RMSE, A (event trigger) / centre', squares(s, 'A'), centre, True),
        ratio('measurements and estimates sent, A / centre', s['A: messages'], s['centre: messages']),
        mean('messages an epoch, B', s['B: messages']),
        root_mean('RMSE, centre', centre, 'm'),
    ]


def knowing(s: Samples) -> Sequence[Figure]:
    """A filter that knows the body, and those that do not."""
    known = squares(s, 'C')
    others = ('A', 'B', 'D', 'E', 'centre')
    return [
        *(ratio(f'RMSE, C / {n}', known, squares(s, n), True, shape=(None, 0.5)) for n in others),
        ratio('RMSE, C / C as the document has it', known, squares(s, 'C, document'), True),
        root_mean('RMSE, C', known, 'm'),
    ]


def losing(s: Samples) -> Sequence[Figure]:
    """Half of the packets."""
    return [
        *(
            ratio(
                f'RMSE, {n}, half lost / none',
                squares(s, n, 0.5),
                squares(s, n),
                True,
                shape=(None, 3.0 if n == 'A' else 1.8),
            )
            for n in SHOWN
        ),
        *(mean(f'NEES (of 2), {n}, half lost', s[f'{n} 0.5: nees']) for n in SHOWN),
    ]


CLAIMS = (
    Claim(
        'X1',
        'X',
        'a_loop',
        'On a robot among twelve nodes, all five systems are far better than places of single epochs, and those that '
        'are told every measurement are as good as one central filter, within 25 %.',
        SIMULATED['a_loop'],
        filtering,
        remark='A sends what its event trigger lets through, a third of it, and is less accurate for that.',
        kind=BEYOND,
    ),
    Claim(
        'X2',
        'X',
        'c_walk',
        'On a person whose body shades the radio, only the filter that knows the body tracks at all.',
        SIMULATED['c_walk'],
        knowing,
        remark='The others are told that signal strengths scatter by 7.2 dB, body and noise in one. It does not help: '
        'the body shifts all nodes on one side alike, towards the person or away.',
        kind=BEYOND,
    ),
    Claim(
        'X3',
        'X',
        'a_loop, half of the packets lost',
        'With half of the packets lost, no system loses its target; those that are told every measurement are at most '
        '1.8 times less accurate.',
        SIMULATED['a_loop'],
        losing,
        kind=BEYOND,
    ),
)

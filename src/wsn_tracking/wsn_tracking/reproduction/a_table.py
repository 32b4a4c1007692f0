"""Seed 000, table 1: filters of random process noise, by the interval that it is drawn from."""

from __future__ import annotations

from collections.abc import Sequence

from wsn_tracking.reproduction.a_circle import CIRCLE, key
from wsn_tracking.reproduction.a_printed import TABLE_1, WORDS, told_local
from wsn_tracking.reproduction.claims import Claim, Figure, Plot, Samples, Series
from wsn_tracking.reproduction.quantities import bars, change, mean, ratio
from wsn_tracking.studies.random_q_noise import INTERVALS


def order(s: Samples) -> Sequence[Figure]:
    """Local errors by interval, against those of [6,8]."""
    best = s['local [6,8]']
    told = {i: told_local(i) / told_local((6.0, 8.0)) for i in INTERVALS}
    least = {(2.0, 6.0): 1.05, (8.0, 12.0): 1.025, (8.0, 10.0): 1.01}
    return [
        mean('EI [6,8]', best, 'cm', 100.0, document=told_local((6.0, 8.0)), shape=(6.9, 11.5), near=(8.75, 9.67)),
        *(
            ratio(
                f'EI {key(i)} / EI [6,8]',
                s[f'local {key(i)}'],
                best,
                document=told[i],
                shape=(low, None),
                near=(told[i] - 0.02, told[i] + 0.02),
            )
            for i, low in least.items()
        ),
        ratio(
            'EI [2,6] / EI [8,12]',
            s['local [2,6]'],
            s['local [8,12]'],
            document=told[2.0, 6.0] / told[8.0, 12.0],
            shape=(1.01, None),
        ),
        ratio('EI [8,12] / EI [8,10]', s['local [8,12]'], s['local [8,10]'], document=1.0250, shape=(1.005, None)),
        *cells(s),
    ]


def cells(s: Samples) -> list[Figure]:
    """The whole table 1, with the mean of the three locals."""
    found = []
    for i in INTERVALS:
        told = (told_local(i), *TABLE_1[i][3:])
        for rule, number in zip(('local', 'mean', 'lci', 'trace'), told, strict=True):
            name = WORDS.get(rule, 'locals')
            found.append(mean(f'{key(i)}: {name}', s[f'{rule} {key(i)}'], 'cm', 100.0, document=round(number, 4)))
    return found


def plot_locals(s: Samples) -> Sequence[Plot]:
    """What a bad interval costs."""
    best, names = (6.0, 8.0), [key(i) for i in INTERVALS]
    ours = [(name, change('', s[f'local {name}'], s[f'local {key(best)}'])) for name in names]
    told = Series('document', names, [100.0 * (told_local(i) / told_local(best) - 1.0) for i in INTERVALS])
    return [Plot('Local filters', 'q drawn from', 'EI against that of [6,8] [%]', [bars('ours', ours), told])]


CLAIMS = (
    Claim(
        'A3',
        'A',
        'table 1',
        'Locals with q drawn at random are the worse, the farther their interval lies from 7, and [2,6] is worst.',
        CIRCLE,
        order,
        plot_locals,
    ),
)

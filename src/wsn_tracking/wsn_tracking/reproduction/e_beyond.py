"""Beyond seed 004: whether the filter knows its error, and how far it is from the best."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from wsn_tracking.reproduction.claims import BEYOND, Claim, Figure, Plot, Samples, Series
from wsn_tracking.reproduction.e_losses import WORDS
from wsn_tracking.reproduction.e_sweep import RATES, SWEEP
from wsn_tracking.reproduction.quantities import bars, mean, median, ratio
from wsn_tracking.studies.loss import FILTERS


def honest(s: Samples) -> Sequence[Figure]:
    """NEES and growth of the error."""
    return [
        *(
            median(f'NEES (of 2) of the median run, {p:.0%} lost', s[f'ckf {p:g}: nees'], shape=(1.2, 2.4))
            for p in RATES
        ),
        *(
            ratio(
                f'RMSE at {q:.0%} / at {p:.0%} lost',
                s[f'ckf {q:g}: squares'],
                s[f'ckf {p:g}: squares'],
                root=True,
                shape=(1.0, None),
            )
            for p, q in pairwise(RATES)
        ),
        *(ratio(f'RMSE / best, {p:.0%} lost', s[f'ckf {p:g}: squares'], s[f'bound {p:g}'], root=True) for p in RATES),
        *(mean(f'{WORDS[name]}: tracks lost at 90 %', s[f'{name} 0.9: lost'], '%', 100.0) for name in FILTERS),
        *(mean(f'messages that arrive an epoch, {p:.0%} lost', s[f'messages {p:g}']) for p in RATES),
    ]


def honesty(s: Samples) -> Sequence[Plot]:
    """NEES and distance to the best by rate."""
    nees = [(p, median('', s[f'ckf {p:g}: nees'])) for p in RATES]
    best = [(p, ratio('', s[f'ckf {p:g}: squares'], s[f'bound {p:g}'], root=True)) for p in RATES]
    right = Series('honest', [RATES[0], RATES[-1]], [2.0, 2.0], style='truth')
    rate = 'share of lost packets'
    return [
        Plot('Does it know its error?', rate, 'NEES of the median run', [right, bars('ours', nees)]),
        Plot('Distance to the best', rate, 'RMSE / best', [bars('ours', best)]),
    ]


CLAIMS = (
    Claim(
        'E21',
        'E',
        'honesty',
        'The error grows with the loss rate, and the filter knows by how much.',
        SWEEP,
        honest,
        honesty,
        'NEES are medians, since one track that is lost outweighs all others in a mean. Best: a filter with the '
        'same noise that is linearised at the truth (Cramer-Rao recursion along each true path).',
        kind=BEYOND,
    ),
)

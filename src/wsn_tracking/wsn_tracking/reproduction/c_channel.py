"""Seed 003, figure 1: loudness by distance with a body between, and without."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.body import LOS, NLOS, SINGLE_PRINTED, Curve, mean_rssi
from wsn_tracking.reproduction.claims import PICTURE, Claim, Experiment, Figure, Plot, Samples, Series, nothing
from wsn_tracking.reproduction.quantities import mean

NEAR, FAR, SPEED = 0.3, 20.0, 0.8  # [m], [m], [m/s]
PERIOD, NOISE = 0.1, 3.0  # [s], [dB]: neither is told
WAYS = {'in line of sight': LOS, 'behind the body': NLOS}


def fitted(d: Floats, y: Floats) -> Floats:
    """P_ref and K (runs, 2) of P_ref + K lg d through readings y (runs, n) at distances d (n,)."""
    A = np.column_stack([np.ones_like(d), np.log10(d)])
    return np.asarray(np.linalg.lstsq(A, y.T, rcond=None)[0].T)


def walks(seed: int, runs: int) -> Samples:
    """Somebody walks away from a node and back to it; curves through what it reads on each way, and on both."""
    d = np.arange(NEAR, FAR, SPEED * PERIOD)
    generator = np.random.default_rng(seed)
    y = {name: mean_rssi(curve, d) + NOISE * generator.standard_normal((runs, d.size)) for name, curve in WAYS.items()}
    samples: dict[str, Floats] = {f'fit {name}': fitted(d, read) for name, read in y.items()}
    samples['fit one'] = fitted(np.tile(d, len(y)), np.concatenate(list(y.values()), axis=1))
    return {**samples, f'{PICTURE}d': d, **{f'{PICTURE}{name}': read[0] for name, read in y.items()}}


WALKS = Experiment('c channel', walks, runs=50, units=4, quick=2)


def one_curve(s: Samples) -> Sequence[Figure]:
    """The curve through both ways, beside what is printed."""
    printed = SINGLE_PRINTED
    found = [
        mean('one curve: K', s['fit one'][:, 1], 'dB', document=printed.k, shape=(-25.0, -23.0), near=(-24.3, -23.6)),
        mean('one curve: P_ref', s['fit one'][:, 0], 'dBm', document=printed.p_ref, near=(-46.0, -44.5)),
    ]
    for name, curve in WAYS.items():
        given: Curve = curve
        found += [
            mean(f'{name}: P_ref', s[f'fit {name}'][:, 0], 'dBm', document=given.p_ref),
            mean(f'{name}: K', s[f'fit {name}'][:, 1], 'dB', document=given.k),
        ]
    return found


def plot_1(s: Samples) -> Sequence[Plot]:
    """Readings of a run, and the curves."""
    d = s[f'{PICTURE}d']
    x = d.tolist()
    read = [Series(name, x, s[f'{PICTURE}{name}'].tolist(), style='points') for name in WAYS]
    p_ref, k = s['fit one'][0]
    lines = [('one curve, fitted', Curve(p_ref, k)), ('one curve, as printed', SINGLE_PRINTED)]
    curves = [Series(name, x, mean_rssi(curve, d).tolist()) for name, curve in lines]
    return [Plot('One run', 'distance [m]', 'RSSI [dBm]', [*read, *curves])]


CLAIMS = (
    Claim(
        'C6',
        'C',
        'figure 1, section 2',
        'Measured curves of loudness by distance, with and without the body in between.',
        None,
        nothing,
        impossible='The measurements are not published. The text names the two curves the wrong way round (the louder '
        'one behind the body); its numbers are used here with the names exchanged.',
    ),
    Claim(
        'C7',
        'C',
        'figure 1, section 2',
        'One curve through the readings of both ways is -45.27 - 23.95 lg d.',
        WALKS,
        one_curve,
        plot_1,
        "Readings drawn from the document's own two curves. Its K is found; its constant is not, and cannot be: it is "
        'that of one of the two, printed twice. The filter with one curve has -49.28 here.',
    ),
)

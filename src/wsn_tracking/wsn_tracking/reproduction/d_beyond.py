"""Beyond seed 001: two motion models at once, livelier filters, ranges that are lost."""

from __future__ import annotations

from collections.abc import Sequence

from wsn_tracking.reproduction.claims import BEYOND, Claim, Figure, Samples
from wsn_tracking.reproduction.d_filters import EKF, HYBRID, IMM, LS
from wsn_tracking.reproduction.d_stopping import FREE, LINE, LOST, before, by_time, settling_ratio, soon
from wsn_tracking.reproduction.quantities import median, ratio


def two_models(s: Samples) -> Sequence[Figure]:
    """Two models at once against the hybrid."""
    return [
        ratio(f'RMSE 2 s after the stop, {IMM} / {HYBRID}', soon(s, IMM), soon(s, HYBRID), True, shape=(None, 1.0)),
        ratio(f'RMSE before the stop, {IMM} / {HYBRID}', before(s, IMM), before(s, HYBRID), True),
        settling_ratio(s, IMM, HYBRID, None),
        *(
            ratio(f'RMSE 2 s after the stop, {n} / best', soon(s, n), soon(s, 'bound'), True)
            for n in (LS, EKF, HYBRID, IMM)
        ),
        *(median(f'NEES (of 2) before the stop, {n}', before(s, f'{n}: nees')) for n in (EKF, HYBRID, IMM)),
        *(median(f'NEES (of 2) 2 s after it, {n}', soon(s, f'{n}: nees')) for n in (EKF, HYBRID, IMM)),
    ]


def lively(s: Samples) -> Sequence[Figure]:
    """With ten times the process noise there is less to win."""
    return [
        ratio(f'RMSE 2 s after the stop, {HYBRID} / {EKF}', soon(s, HYBRID), soon(s, EKF), True, shape=(None, 1.1)),
        ratio(f'RMSE before the stop, {HYBRID} / {EKF}', before(s, HYBRID), before(s, EKF), True, shape=(None, 1.1)),
        settling_ratio(s, EKF, HYBRID, None),
    ]


def dropouts(s: Samples) -> Sequence[Figure]:
    """With ranges that are lost."""
    return [
        ratio(f'RMSE 2 s after the stop, {HYBRID} / {EKF}', soon(s, HYBRID), soon(s, EKF), True, shape=(None, 1.1)),
        ratio(f'RMSE before the stop, {HYBRID} / {EKF}', before(s, HYBRID), before(s, EKF), True, shape=(None, 1.15)),
        ratio(f'RMSE 2 s after the stop, {IMM} / {HYBRID}', soon(s, IMM), soon(s, HYBRID), True),
    ]


CLAIMS = (
    Claim(
        'D21',
        'D',
        'two models',
        'Two motion models that run at once (imm) are better after a stop than the hybrid, without thresholds.',
        LINE,
        two_models,
        lambda s: [by_time(s)],
        'On a straight line at 0.5 m/s. The price: between manoeuvres its track is noisier. Best: a filter that knows '
        'when the robot stops and all else but how fast it goes on (Cramer-Rao recursion). All filters hear the same '
        'range a period: 20 messages of 18 bytes a second.',
        kind=BEYOND,
    ),
    Claim(
        'D23',
        'D',
        'process noise',
        'With ten times the process noise, where the Kalman filter is quick itself, the hybrid does no harm.',
        FREE,
        lively,
        lambda s: [by_time(s)],
        kind=BEYOND,
    ),
    Claim(
        'D22',
        'D',
        'lost ranges',
        'With 30 % of the ranges lost, the hybrid is no worse than the Kalman filter.',
        LOST,
        dropouts,
        lambda s: [by_time(s)],
        'It asks least squares only where its ranges are fresh; without that, lost ranges ruin it.',
        kind=BEYOND,
    ),
)

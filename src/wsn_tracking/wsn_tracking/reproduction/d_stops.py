"""Seed 001, table 1 and figure 4: least squares, Kalman filter and their hybrid on a robot that stops dead."""

from __future__ import annotations

from collections.abc import Sequence

from wsn_tracking.reproduction.claims import Claim, Figure, Samples
from wsn_tracking.reproduction.d_filters import EKF, HYBRID, LS
from wsn_tracking.reproduction.d_stopping import (
    ARC,
    LINE,
    before,
    by_time,
    one_run,
    settling,
    settling_ratio,
    soon,
    stopped,
)
from wsn_tracking.reproduction.quantities import bootstrapped, ratio


def table_1(s: Samples) -> Sequence[Figure]:
    """Least squares and EKF, each with its fault."""
    return [
        ratio(f'RMSE before the stop, {LS} / {EKF}', before(s, LS), before(s, EKF), True, shape=(1.5, None)),
        settling_ratio(s, EKF, LS, (1.5, None)),
    ]


def figure_4(s: Samples) -> Sequence[Figure]:
    """The hybrid: the EKF's smoothness before the stop, nearly the quickness of least squares after it."""
    time = settling(stopped(s))
    return [
        ratio(f'RMSE before the stop, {HYBRID} / {EKF}', before(s, HYBRID), before(s, EKF), True, shape=(0.95, 1.05)),
        ratio(f'RMSE before the stop, {LS} / {HYBRID}', before(s, LS), before(s, HYBRID), True, shape=(1.2, None)),
        settling_ratio(s, EKF, HYBRID, (2.0, None)),
        settling_ratio(s, HYBRID, LS, (1.0, None)),
        ratio(f'RMSE 2 s after the stop, {EKF} / {HYBRID}', soon(s, EKF), soon(s, HYBRID), True, shape=(1.8, None)),
        *(bootstrapped(f'settling, {n}', lambda v: time(v[0]), [s[n]], 's') for n in (LS, HYBRID, EKF)),
    ]


def on_an_arc(s: Samples) -> Sequence[Figure]:
    """On a path that the motion model does not know, the EKF is slow all the time."""
    return [
        ratio(f'RMSE before the stop, {HYBRID} / {EKF}', before(s, HYBRID), before(s, EKF), True, shape=(None, 1.1)),
        ratio(f'RMSE before the stop, {LS} / {HYBRID}', before(s, LS), before(s, HYBRID), True, shape=(1.2, None)),
        settling_ratio(s, EKF, HYBRID, (2.0, None)),
        settling_ratio(s, HYBRID, LS, (1.0, None)),
        ratio(f'RMSE 2 s after the stop, {EKF} / {HYBRID}', soon(s, EKF), soon(s, HYBRID), True, shape=(1.5, None)),
    ]


CLAIMS = (
    Claim(
        'D1',
        'D',
        'table 1',
        'Least squares follows at once but is noisy; the Kalman filter is smooth but slow to settle.',
        LINE,
        table_1,
        lambda s: [by_time(s)],
        'The cells of the table are lost; the text around it says this.',
    ),
    Claim(
        'D2',
        'D',
        'figure 4',
        'At a sudden stop between two cells, the hybrid is as smooth as the Kalman filter before the stop and far '
        'quicker after it, if not as quick as least squares.',
        LINE,
        figure_4,
        lambda s: [one_run(s), by_time(s)],
        'A straight line at 0.5 m/s. Settling: the last time at which the RMSE over all runs exceeds 4 cm. Process '
        'noise 0.001 m^2/s^3; the document does not tell its own.',
    ),
    Claim(
        'D3',
        'D',
        'figure 4',
        'So it is on the path of the document, an arc at 0.5 rad/s.',
        ARC,
        on_an_arc,
        lambda s: [one_run(s), by_time(s)],
        'A stiff Kalman filter that knows no turns is off on the whole arc; the hybrid takes the turn for a '
        'manoeuvre, and is better before the stop, too.',
    ),
)

"""Does a filter know its own error? The interval in which its mean NEES should lie.

N independent epochs of a consistent filter sum to a NEES that is chi-square with N d degrees of freedom.
Successive errors of one run are NOT independent: taking N for the number of epochs gives a bound that is too
narrow and rejects good filters. So N is by default the EFFECTIVE number of epochs, from the autocorrelation
of the NEES itself; chi-square with N_eff d degrees then has the right mean and the right variance. On
consistent AR(1) errors of coefficient 0.9 and 115 epochs, it accepts 89 % where the plain N accepts 50 %
(95 % of both are meant); runs worth fewer than ten independent epochs are still judged too strictly.
"""

from __future__ import annotations

import math
from statistics import NormalDist

import numpy as np

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import Floats

LARGEST = 1e100  # a NEES beyond, infinity too, is as wrong: its squares are numbers still


def nees_interval(epochs: float, dimension: int = 2, level: float = 0.95) -> tuple[float, float]:
    """Two-sided acceptance interval of the mean NEES of `epochs` independent epochs (need not be whole).

    (NaN, NaN) without any epoch. Bar-Shalom, Li, Kirubarajan: Estimation with Applications to Tracking
    and Navigation, section 5.4.
    """
    if not epochs > 0.0:
        return math.nan, math.nan
    dof = epochs * dimension
    tail = 0.5 * (1.0 - level)
    return chi_square_quantile(tail, dof) / epochs, chi_square_quantile(1.0 - tail, dof) / epochs


def effective_epochs(series: Floats) -> Floats:
    """How many independent values a correlated series is worth, (..., K) -> (...), between 1 and its length.

    K / tau with tau = 1 + 2 sum of the autocorrelations, cut where the sum of two neighbouring lags is no
    longer positive and kept from rising again (Geyer 1992, initial monotone sequence). NaN values are left
    out; a series that never varies is worth one value, an empty one none.
    """
    series = np.minimum(series, LARGEST)
    known = ~np.isnan(series)
    count = known.sum(axis=-1)
    size = series.shape[-1]
    total = np.where(known, series, 0.0).sum(axis=-1)
    deviation = np.where(known, series - (total / np.maximum(count, 1))[..., None], 0.0)
    spectrum = np.fft.rfft(deviation, n=2 * size + 2, axis=-1)  # padded: no wrap-around
    autocovariance = np.fft.irfft(np.abs(spectrum) ** 2, n=2 * size + 2, axis=-1)[..., : size + size % 2]
    variance = np.sum(deviation**2, axis=-1)
    varies = variance > count * (1e-12 * np.abs(total) / np.maximum(count, 1)) ** 2
    pairs = autocovariance.reshape(*autocovariance.shape[:-1], -1, 2).sum(axis=-1)
    pairs = pairs / np.where(varies, variance, 1.0)[..., None]
    positive = np.logical_and.accumulate(pairs > 0.0, axis=-1)
    tau = 2.0 * np.sum(np.where(positive, np.minimum.accumulate(pairs, axis=-1), 0.0), axis=-1) - 1.0
    worth = np.where(varies, count / np.maximum(tau, 1.0), 1.0)
    return np.asarray(np.minimum(np.maximum(worth, 1.0), count))


def pooled_epochs(epochs: Floats, effective: Floats) -> float:
    """Effective epochs of the mean over several runs of (R,) epochs, each worth (R,) effective epochs.

    The variance of a run's sum grows as epochs^2 / effective, and the runs are independent.
    """
    used = epochs > 0
    if not np.any(used):
        return 0.0
    return float(np.sum(epochs[used]) ** 2 / np.sum(epochs[used] ** 2 / effective[used]))


def chi_square_quantile(p: float, dof: float) -> float:
    """Where the chi-square distribution with `dof` >= 1 degrees of freedom (any real) reaches p in (0, 1).

    Newton on the incomplete gamma function from the Wilson-Hilferty guess, kept in a bracket. Done here
    because a node would pay a second and 40 MB for SciPy.
    """
    if not (0.0 < p < 1.0 and 1.0 <= dof < math.inf):
        raise TrackingError(f'chi-square quantile of p = {p}, dof = {dof}: expected 0 < p < 1 and a finite dof >= 1')
    a = 0.5 * dof
    spread = 2.0 / (9.0 * dof)
    guess = a * (1.0 - spread + NormalDist().inv_cdf(p) * math.sqrt(spread)) ** 3
    if guess <= 0.0:  # one degree of freedom far in the lower tail: the leading term of the series instead
        guess = math.exp((math.log(p) + math.lgamma(a + 1.0)) / a)
    low, high, x = 0.0, math.inf, guess
    for _ in range(200):  # six are usual
        excess = _gamma_p(a, x) - p
        low, high = (low, x) if excess > 0.0 else (x, high)
        density = math.exp((a - 1.0) * math.log(x) - x - math.lgamma(a))
        step = x - excess / density if density > 0.0 else math.nan
        if not low < step < high:
            step = 0.5 * (low + high) if high < math.inf else 2.0 * x
        if abs(step - x) <= 1e-14 * x:
            break
        x = step
    return 2.0 * x


def _gamma_p(a: float, x: float) -> float:
    """Regularised lower incomplete gamma function: series below a + 1, continued fraction (Lentz) above."""
    scale = math.exp(a * math.log(x) - x - math.lgamma(a))
    if x < a + 1.0:
        term = total = 1.0 / a
        n = a
        while term > 1e-17 * total:
            n += 1.0
            term *= x / n
            total += term
        return scale * total
    b = x + 1.0 - a
    c, d = math.inf, 1.0 / b
    h, k, ratio = d, 0.0, 0.0
    while abs(ratio - 1.0) > 1e-16 and k < 1e6:
        k += 1.0
        step = k * (a - k)
        b += 2.0
        d = 1.0 / (b + step * d)
        c = b + step / c
        ratio = c * d
        h *= ratio
    return 1.0 - scale * h

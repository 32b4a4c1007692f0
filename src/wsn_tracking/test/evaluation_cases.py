"""Small truths, estimates and summaries for the tests of the evaluation."""

from __future__ import annotations

import numpy as np

from wsn_tracking.evaluation.score import score
from wsn_tracking.evaluation.summary import Summary, Traffic
from wsn_tracking.sensing.recording import Truth
from wsn_tracking.trackers.estimate import Estimate, Kind

T0 = 1_700_000_000_123_456_789
SECOND = 1_000_000_000
EYE = np.eye(2)


def line_truth(epochs=30, target_id=7, speed=(1.0, 0.5)):
    """A target that leaves (2, 1) at `speed`, recorded every second."""
    seconds = np.arange(epochs)
    xy = np.array([2.0, 1.0]) + seconds[:, None] * np.array(speed)
    positions = np.column_stack([xy, np.full(epochs, 0.3)])
    return Truth(target_id, T0 + seconds * SECOND, positions, np.full((epochs, 3), np.nan))


def estimate(stamp_ns, xy, covariance=None, **fields):
    """One planar estimate; without a covariance it is not known."""
    block = np.full((4, 4), np.nan) if covariance is None else np.eye(4)
    if covariance is not None:
        block[:2, :2] = covariance
    values = {'target_id': 7, 'request_seq': 0, 'source': 'local_1', 'kind': Kind.LOCAL, **fields}
    return Estimate(stamp_ns=int(stamp_ns), mean=np.array([*xy, 0.0, 0.0]), covariance=block, **values)


def track(truth, errors, covariance=None, **fields):
    """An estimate at every stamp of the truth, off by `errors` (K, 2)."""
    places = truth.positions[:, :2] + errors
    return [estimate(t, xy, covariance, **fields) for t, xy in zip(truth.stamps_ns, places, strict=True)]


def noisy_track(seed=1, epochs=60, covariance=((0.04, 0.01), (0.01, 0.09)), **fields):
    """A truth and a white track of it, scaled so that its mean NEES is 2: consistent whatever the seed."""
    truth = line_truth(epochs, speed=(0.06, 0.03))
    cov = np.array(covariance)
    white = np.random.default_rng(seed).standard_normal((epochs, 2))
    white /= np.sqrt(np.mean(white**2))
    return truth, track(truth, white @ np.linalg.cholesky(cov).T, cov, **fields)


def a_summary(seed=1, title='a_loop', outputs=('local_1', 'fused_1'), **fields):
    """A summary of white tracks, and one of an output that has no covariance."""
    scores = {}
    for i, name in enumerate(outputs):
        truth, estimates = noisy_track(seed + i, source=name)
        scores[name] = score(estimates, truth)
    truth = line_truth()
    scores['mean'] = score(track(truth, np.full((30, 2), 0.1)), truth)
    values = {
        'epochs': 60,
        'outputs': scores,
        'input': {'late': 2, 'duplicate': 3, 'other_target': 0},
        'traffic': Traffic(sent=41, in_radius=100, received=164),
        **fields,
    }
    return Summary(title=title, target_id=7, **values)

"""The particle filter of system C, one step after the other, for one run or many at once (seed 003, section 3.4)."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wsn_tracking.filters.adaptive import enough
from wsn_tracking.filters.linalg import some
from wsn_tracking.filters.link_offsets import Offsets, drifted, learnt, unknown
from wsn_tracking.filters.particle import Cloud, descended, equal, moments, resampled, reweighed, taken, worth
from wsn_tracking.filters.resampling import RESAMPLERS, Indices
from wsn_tracking.models.anchors import Anchors, Floats, Mask
from wsn_tracking.models.body_likelihood import BodyLikelihood, Readings, Scored
from wsn_tracking.models.map_excess import excess
from wsn_tracking.models.radio_map import RadioMap
from wsn_tracking.models.region import Region
from wsn_tracking.models.walk import PLANAR, STATES, kept
from wsn_tracking.trackers.human_config import HumanConfig
from wsn_tracking.trackers.human_models import drift_of, kld_of, transition_of, walk_of
from wsn_tracking.trackers.human_places import Area, Places

LONGEST_STEP = 1.0  # [s] of one transition of a walk, and of a straight way that must not meet a wall
FLOOR = 1e-3  # [m, m/s] least standard deviation that is told
NOBODY = np.zeros((), dtype=np.bool_)
BEHIND = slice(STATES, None)  # rows of particles behind those of the walk: offsets of the links


class Track(NamedTuple):
    """What is kept from epoch to epoch."""

    cloud: Cloud
    started: Mask  # (...) whether the particles have been placed by what was heard
    strikes: NDArray[np.int64]  # (...) epochs in a row that contradicted the particles
    parents: Indices | None = None  # (..., P) where the particles were in the cloud of the last epoch
    V: Floats | None = None  # (..., N) [dB^2] variance of the links' offsets
    silent: Floats | float = 0.0  # (...) [s] since something was heard


class Step(NamedTuple):
    """One epoch."""

    track: Track  # resampled, for the next epoch
    prior: Cloud  # predicted, before what was heard
    readings: Readings  # what was heard, as uncertain as the links' offsets make it
    cloud: Cloud  # as the estimate saw it
    parents: Indices | None  # (..., P) of these particles in the cloud of the epoch before
    mean: Floats  # (..., 4) position and velocity
    covariance: Floats  # (..., 4, 4)
    evidence: Floats  # (...) log p(z_t | z_1:t-1) [dB^-N]
    by_node: Floats | None  # (..., N) the same of each node, where it was needed
    n_eff: Floats  # (...)
    reset: Mask  # (...) whether the particles were drawn anew


class HumanFilter:
    """Configuration and nodes; `begin`, then one `step` an epoch.

    floor: where a person can be, beside the area, and through whose edges nobody walks. radio_map: what nodes should
    read beyond their curves; its columns are those of the anchors.
    """

    def __init__(
        self,
        config: HumanConfig,
        anchors: Anchors,
        area: Area,
        floor: Region | None = None,
        radio_map: RadioMap | None = None,
    ) -> None:
        self.config = config
        self.area = area
        self.likelihood = BodyLikelihood(
            config.kernel, anchors.positions, config.target_height, config.signal.least_distance
        )
        self._transition = transition_of(config)
        steps = config.motion_kind == 'walk' or (config.motion_kind == 'random_walk' and floor is not None)
        self._longest = LONGEST_STEP if steps else math.inf
        self._map = radio_map
        self._drift = drift_of(config)
        self._nodes = anchors.ids.size
        self._places = Places(area, floor, walk_of(config), self._nodes if self._drift is not None else 0)
        self._resample = RESAMPLERS[config.resampling.kind]
        self._kld = kld_of(config)

    def begin(self, runs: tuple[int, ...], generator: np.random.Generator) -> Track:
        """Particles anywhere."""
        s = self._places.anywhere(runs, self.config.particles, generator)
        V = None if self._drift is None else unknown(self._drift, (*runs, self._nodes), 1).V
        return Track(equal(s), np.full(runs, self.config.draws == 0), np.zeros(runs, dtype=np.int64), V=V)

    def step(self, track: Track, dt: float, readings: Readings, generator: np.random.Generator) -> Step:
        """One epoch dt [s] after the last; dt <= 0: nobody moves. Readings are of the nodes (N,) in every run."""
        heard = ~np.isnan(readings.z)
        any_heard = heard.any(axis=-1)
        s, V = self._drifted(self._moved(track.cloud.s, dt, generator), track.V, dt)
        prior, told = Cloud(s, track.cloud.log_w), widened(readings, V)
        scored = self.score(s, told, prior.w if self.config.reset_epochs else None)
        cloud, evidence = reweighed(prior, scored.l)
        strikes, lost = self._struck(track, told, scored.by_node, heard)
        silent = track.silent + max(dt, 0.0)
        thin = track.started & self._is_thin(silent)
        anew = (lost | ~track.started | thin) & any_heard
        parents = track.parents
        if some(anew):
            near = prior if np.any(thin & ~lost & any_heard) else None
            cloud, parents, V = self._placed(cloud, near, thin & ~lost, parents, V, anew, readings, generator)
        w = cloud.w
        cloud, V = self._learnt(cloud, V, readings, w)
        mean, covariance = moments(cloud.s[..., PLANAR, :], w, FLOOR)
        n_eff = worth(w)
        after = self._next(cloud, w, n_eff, generator)
        started, strikes = track.started | any_heard, np.where(anew, 0, strikes)
        following = Track(after[0], started, strikes, after[1], V, np.where(any_heard, 0.0, silent))
        reset = anew & track.started
        return Step(following, prior, told, cloud, parents, mean, covariance, evidence, scored.by_node, n_eff, reset)

    def evidence_by_node(self, step: Step) -> Floats:
        """log p(z_i | z_1:t-1) (..., N) of each node; 0 where nothing was heard."""
        if step.by_node is not None:
            return step.by_node
        by_node = self.score(step.prior.s, step.readings, step.prior.w).by_node
        assert by_node is not None
        return by_node

    def score(self, s: Floats, readings: Readings, w: Floats | None = None) -> Scored:
        """Log-likelihood of an epoch at particles (..., S, P)."""
        return self.likelihood(s, readings, w, self._excess(s))

    def _excess(self, s: Floats) -> Floats | None:
        """What nodes should read at particles beyond their curves, (..., N, P) [dB]: the map's and their links'."""
        beyond_curves = None if self._map is None else excess(self._map, s)
        if self._drift is None:
            return beyond_curves
        return s[..., BEHIND, :] if beyond_curves is None else beyond_curves + s[..., BEHIND, :]

    def _drifted(self, s: Floats, V: Floats | None, dt: float) -> tuple[Floats, Floats | None]:
        """The offsets of the links dt [s] later."""
        if self._drift is None or V is None or dt <= 0.0:
            return s, V
        return _with_offsets(s, drifted(Offsets(s[..., BEHIND, :], V), self._drift, dt))

    def _learnt(self, cloud: Cloud, V: Floats | None, readings: Readings, w: Floats) -> tuple[Cloud, Floats | None]:
        """What an epoch tells of the links."""
        if V is None:
            return cloud, V
        e = self.likelihood.residuals(cloud.s, readings, self._excess(cloud.s))
        after = learnt(Offsets(cloud.s[..., BEHIND, :], V), e, readings.sigma, w, self.config.signal.dof)
        s, V = _with_offsets(cloud.s, after)
        return cloud._replace(s=s), V

    def _moved(self, s: Floats, dt: float, generator: np.random.Generator) -> Floats:
        if dt <= 0.0:
            return s
        steps = max(math.ceil(dt / self._longest), 1)
        for _ in range(steps):
            after = self._transition(s, dt / steps, generator)
            s = kept(s, after, self._places.left(s, after), generator)
        return s

    def _is_thin(self, silent: Floats | float) -> Mask:
        """Where nothing was heard for so long that the particles are too thin for an epoch to choose among them."""
        patience = self.config.start.silence
        return np.asarray(silent >= patience if patience else np.zeros_like(silent, dtype=np.bool_))

    def _struck(
        self, track: Track, readings: Readings, by_node: Floats | None, heard: Mask
    ) -> tuple[NDArray[np.int64], Mask]:
        """How often in a row the median node has contradicted the particles, and where that is too often."""
        start = self.config.start
        if by_node is None:
            return track.strikes, NOBODY
        surprise = np.where(heard, -by_node - np.log(readings.sigma), np.nan)
        counts = heard.sum(axis=-1) >= start.reset_nodes
        median = _median(surprise)
        strikes = np.where(counts, np.where(median > start.reset_excess, track.strikes + 1, 0), track.strikes)
        return strikes, np.asarray((strikes >= self.config.reset_epochs) & track.started)

    # ---- placing particles

    def _placed(
        self,
        cloud: Cloud,
        near: Cloud | None,
        thin: Mask,
        parents: Indices | None,
        V: Floats | None,
        anew: Mask,
        readings: Readings,
        generator: np.random.Generator,
    ) -> tuple[Cloud, Indices | None, Floats | None]:
        """The cloud with particles drawn by the likelihood of the epoch alone where `anew`, and of links unknown.

        Where they are `thin`, most of the places that are weighed are about those that the cloud `near` had predicted.
        Their parents are drawn by the old weights: whoever asks where he was hears what was believed then.
        """
        P, batch = cloud.log_w.shape[-1], np.ndim(anew) > 0
        if self._drift is not None and V is not None:
            V = np.where(anew[..., None], self._drift.std**2, V)
            readings = widened(readings, V)
        z, sigma = (column[anew] if batch else column for column in readings[:2])
        n = max(self.config.draws, P)
        candidates = self._places.anywhere(z.shape[:-1], n, generator)
        if near is not None:
            of_them = Cloud(near.s[anew], near.log_w[anew]) if batch else near
            thin = thin[anew] if batch else thin
            candidates = self._places.about(candidates, of_them, thin, self._resample, generator)
        scored, _ = reweighed(equal(candidates), self.score(candidates, readings._replace(z=z, sigma=sigma)).l)
        new = taken(candidates, self._resample(scored.w, P, generator))
        came_from = self._resample(cloud.w, P, generator)
        if batch:
            s, log_w = cloud.s.copy(), cloud.log_w.copy()
            s[anew], log_w[anew] = new, -np.log(P)
            came_from = np.where(anew[..., None], came_from, np.arange(P))
        else:
            s, log_w, _ = equal(new)
        return Cloud(s, log_w), descended(parents, came_from), V

    def _next(
        self, cloud: Cloud, w: Floats, n_eff: Floats, generator: np.random.Generator
    ) -> tuple[Cloud, Indices | None]:
        """Resampled where too few particles count."""
        r = self.config.resampling
        P = cloud.log_w.shape[-1]
        low = n_eff < r.threshold * P
        n = P
        if self._kld is not None and cloud.log_w.ndim == 1:
            n = enough(self._kld, taken(cloud.s[:2], self._resample(w, P, generator)))
            low = low | (abs(n - P) > 0.1 * P)
            n = n if low else P
        after = resampled(cloud, self._resample, generator, ~low if r.inverted else low, n, w)
        return after.cloud, after.parents


def _median(values: Floats) -> Floats:
    """Median over the last axis of what is not NaN; NaN where all are."""
    ordered = np.sort(values, axis=-1)  # NaN sorts to the end
    count = (~np.isnan(ordered)).sum(axis=-1)
    low, high = np.maximum(count - 1, 0) // 2, np.minimum(count // 2, max(values.shape[-1] - 1, 0))
    pick = [np.take_along_axis(ordered, at[..., None], axis=-1)[..., 0] for at in (low, high)]
    return np.asarray(0.5 * (pick[0] + pick[1]))


def widened(readings: Readings, V: Floats | None) -> Readings:
    """Readings whose links have offsets of variance V (..., N) [dB^2]."""
    return readings if V is None else readings._replace(sigma=np.sqrt(readings.sigma**2 + V))


def _with_offsets(s: Floats, offsets: Offsets) -> tuple[Floats, Floats]:
    """Particles with these offsets, and their variance."""
    s = s.copy()
    s[..., BEHIND, :] = offsets.b
    return s, offsets.V

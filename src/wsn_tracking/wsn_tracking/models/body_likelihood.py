"""Log-likelihood of an epoch's signal strengths at particles: the inner loop over nodes and particles.

Arrays are (..., N, P), nodes by particles, particles contiguous, in work arrays that are kept from call to call: what
is returned is new, everything else is private scratch.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.body import LEAST_DISTANCE, Curve, Curves
from wsn_tracking.models.node_geometry import Geometry, ahead, geometry, log_squared_distances, of_nodes
from wsn_tracking.models.work import Work

SPAN_DB = 60.0  # an outlier reads anything within so much
LG_SQUARED = 0.5 / math.log(10.0)  # lg d = LG_SQUARED ln d^2
SMALLEST = -290.0  # lg of a product of likelihoods that is still a number


class Kernel(NamedTuple):
    """How a residual is weighed."""

    kind: str = 'soft'  # single, max (seed 003, eq. 15), direction (eq. 13), soft
    dof: float = 0.0  # degrees of freedom of Student-t noise; 0: normal
    outlier: float = 0.0  # share of readings that say nothing, uniform over SPAN_DB
    sharpness: float = 2.0  # soft: k
    least: float = 0.1  # soft: eps, the share of the other curve straight ahead and behind


class Readings(NamedTuple):
    """An epoch's signal strengths."""

    z: Floats  # (..., N) [dBm]; NaN: not heard, which says nothing
    sigma: Floats  # (..., N) [dB]
    curves: Curves  # (N,) or scalars


class Scored(NamedTuple):
    """What an epoch says of particles."""

    l: Floats  # (..., P) log-likelihood [1 / dB each]
    by_node: Floats | None  # (..., N) log sum w p(z_i | particle); 0 where nothing was heard


class BodyLikelihood:
    """Of particles with the states of `models.walk`, by nodes at positions (N, 3) [m]."""

    def __init__(self, kernel: Kernel, positions: Floats, height: float = 0.0, least: float = LEAST_DISTANCE) -> None:
        self.kernel = kernel
        self.positions = positions
        self._nodes = geometry(positions, height, least)
        self._work = Work()

    def __call__(self, s: Floats, readings: Readings, w: Floats | None = None, excess: Floats | None = None) -> Scored:
        """Score particles s (..., S, P).

        w (..., P): weights before the epoch, for `by_node`. excess (..., N, P) [dB]: what a node should read at a
        particle beyond its curves: a radio map's residual, walls, an offset of its link.
        """
        if readings.z.ndim > 1 or not np.isnan(readings.z).any():
            return self._scored(self._nodes, s, readings, w, excess)
        # one run: what was not heard is left out, not masked
        heard = np.flatnonzero(~np.isnan(readings.z))
        by_node = None if w is None else np.zeros(readings.z.size)
        if not heard.size:
            return Scored(np.zeros(s.shape[-1]), by_node)
        off = None if excess is None else excess[heard]
        scored = self._scored(of_nodes(self._nodes, heard), s, _of_nodes(readings, heard), w, off)
        if by_node is not None:
            by_node[heard] = scored.by_node
        return Scored(scored.l, by_node)

    def residuals(self, s: Floats, readings: Readings, excess: Floats | None = None) -> Floats:
        """What nodes read beyond the single curve and `excess` at particles s (..., S, P), (..., N, P) [dB]."""
        single = readings.curves.single
        lg_d2 = log_squared_distances(self._nodes, s, self._work)
        mean = _column(single.p_ref) + _column(single.k * LG_SQUARED) * lg_d2
        return _column(readings.z) - (mean if excess is None else mean + excess)

    def _scored(
        self, nodes: Geometry, s: Floats, readings: Readings, w: Floats | None, excess: Floats | None
    ) -> Scored:
        """The same over the nodes' rows."""
        z, sigma, curves = readings
        kind, heard = self.kernel.kind, ~np.isnan(z)
        lg_d2 = log_squared_distances(nodes, s, self._work)
        shape = lg_d2.shape
        scale = np.where(heard, 1.0 / (math.sqrt(2.0) * sigma), 0.0)
        rest = (np.where(heard, z, 0.0) * scale)[..., None]
        if excess is not None:
            off = np.multiply(excess, scale[..., None], out=self._work.of('rest', shape))
            rest = np.subtract(rest, off, out=off)
        if kind == 'single' and excess is None and w is None and not (self.kernel.dof or self.kernel.outlier):
            return Scored(self._of_polynomial(curves.single, lg_d2, rest, scale, sigma, heard), None)
        if kind == 'single':
            e = self._energy(curves.single, lg_d2, rest, scale, self._work.of('e', shape))
            return self._of_energy(e, sigma, heard, w)
        los = self._energy(curves.los, lg_d2, rest, scale, self._work.of('e', shape))
        nlos = self._energy(curves.nlos, lg_d2, rest, scale, self._work.of('n', shape))
        if kind == 'soft':
            return self._mixed(los, nlos, self._behind(nodes, s, lg_d2), sigma, heard, w)
        if kind == 'direction':
            np.copyto(los, nlos, where=ahead(nodes, s, self._work) <= 0.0)
        else:
            np.minimum(los, nlos, out=los)
        return self._of_energy(los, sigma, heard, w)

    def _behind(self, nodes: Geometry, s: Floats, lg_d2: Floats) -> Floats:
        """Probability p_i that the body is in between: eps + (1 - 2 eps) / (1 + exp(k cos theta))."""
        p = ahead(nodes, s, self._work)
        inverse = np.multiply(lg_d2, -0.5, out=lg_d2)  # the distances are no longer needed
        np.exp(inverse, out=inverse)
        np.multiply(p, inverse, out=p)
        np.multiply(p, self.kernel.sharpness, out=p)
        np.exp(p, out=p)
        np.add(p, 1.0, out=p)
        np.divide(1.0 - 2.0 * self.kernel.least, p, out=p)
        return np.add(p, self.kernel.least, out=p)

    # ---- energies: minus the log of a density, without its constant 1 / (s sqrt(2 pi)) or that of Student's

    def _energy(self, curve: Any, lg_d2: Floats, rest: Floats, scale: Floats, out: Floats) -> Floats:
        """Of the residual about a curve; rest: what was read, times `scale` (..., N): 1 / (s sqrt 2), 0 if nothing."""
        np.multiply(lg_d2, _column(curve.k * LG_SQUARED * scale), out=out)
        level = _column(curve.p_ref * scale)
        if rest.shape[-1] == 1:  # the same at every particle
            np.subtract(rest - level, out, out=out)
        else:
            np.subtract(rest, np.add(out, level, out=out), out=out)
        np.square(out, out=out)
        dof = self.kernel.dof
        if not dof:
            return out
        np.multiply(out, 2.0 / dof, out=out)
        np.log1p(out, out=out)
        return np.multiply(out, 0.5 * (dof + 1.0), out=out)

    def _of_polynomial(self, curve: Any, L: Floats, rest: Floats, scale: Floats, sigma: Floats, heard: Any) -> Floats:
        """Log-likelihood of normal noise about one curve, whose energies sum (a_i - b_i L_i)^2, two products with L."""
        a, b = (rest - _column(curve.p_ref * scale))[..., 0], curve.k * LG_SQUARED * scale
        square = np.multiply(L, L, out=self._work.of('e', L.shape))
        linear = (np.asarray(a * b)[..., None, :] @ L)[..., 0, :]
        quadratic = (np.asarray(b * b)[..., None, :] @ square)[..., 0, :]
        constant = np.where(heard, self._log_constant(sigma), 0.0) - a * a
        return np.asarray(constant.sum(axis=-1)[..., None] + 2.0 * linear - quadratic)

    def _log_constant(self, sigma: Floats) -> Floats:
        """log of that constant."""
        dof = self.kernel.dof
        if not dof:
            return -np.log(sigma) - 0.5 * math.log(2.0 * math.pi)
        student = math.lgamma(0.5 * (dof + 1.0)) - math.lgamma(0.5 * dof) - 0.5 * math.log(dof * math.pi)
        return student - np.log(sigma)

    # ---- from energies to the score

    def _of_energy(self, e: Floats, sigma: Floats, heard: Any, w: Floats | None) -> Scored:
        """Of one density a node and particle."""
        if self.kernel.outlier:
            return self._of_products(np.exp(np.negative(e, out=e), out=e), sigma, heard, w)
        constant = np.where(heard, self._log_constant(sigma), 0.0)
        l = constant.sum(axis=-1)[..., None] - e.sum(axis=-2)
        if w is None:
            return Scored(l, None)
        least = e.min(axis=-1, keepdims=True)
        np.exp(np.subtract(least, e, out=e), out=e)
        return Scored(l, _log(_weighed(e, w)) - least[..., 0] + constant)

    def _mixed(self, los: Floats, nlos: Floats, p: Floats, sigma: Floats, heard: Any, w: Floats | None) -> Scored:
        """Of both densities, the second with probability p."""
        f, g = np.negative(los, out=los), np.negative(nlos, out=nlos)
        if self.kernel.outlier:
            np.exp(f, out=f)
            np.exp(g, out=g)
            np.subtract(g, f, out=g)
            np.multiply(g, p, out=g)
            return self._of_products(np.add(f, g, out=f), sigma, heard, w)
        np.add(g, np.log(p), out=g)
        np.add(f, np.log1p(-p), out=f)
        e = np.negative(np.logaddexp(f, g, out=f), out=f)
        np.copyto(e, 0.0, where=~heard[..., None])
        return self._of_energy(e, sigma, heard, w)

    def _of_products(self, f: Floats, sigma: Floats, heard: Any, w: Floats | None) -> Scored:
        """Of densities with the outliers' share below them: their product needs no logarithm a node.

        (1 - pi) f c + pi / SPAN_DB, divided by the constant c, which goes into the logarithm of the whole.
        """
        pi, log_c = self.kernel.outlier, self._log_constant(sigma)
        floor = np.where(heard, pi / SPAN_DB * np.exp(-log_c), 0.0)
        np.multiply(f, _column(np.where(heard, 1.0 - pi, 1.0)), out=f)
        np.add(f, _column(floor), out=f)
        constant = np.where(heard, log_c, 0.0)
        lowest = float(np.log10(np.where(heard, floor, 1.0)).min())
        at_once = max(int(SMALLEST / min(lowest, -1.0)), 1)
        l = constant.sum(axis=-1)[..., None] + np.zeros(f.shape[-1])
        for first in range(0, f.shape[-2], at_once):
            l += np.log(np.multiply.reduce(f[..., first : first + at_once, :], axis=-2))
        return Scored(l, None if w is None else _log(_weighed(f, w)) + constant)


def _of_nodes(readings: Readings, rows: Any) -> Readings:
    """Only these nodes of (N,)."""
    curves = Curves(*(Curve(*(v if np.ndim(v) == 0 else v[rows] for v in curve)) for curve in readings.curves))
    return Readings(readings.z[rows], readings.sigma[rows], curves)


def _column(values: Floats) -> Floats:
    """(..., N) -> (..., N, 1)."""
    return np.asarray(values)[..., None]


def _weighed(f: Floats, w: Floats) -> Floats:
    """sum over particles of w f, (..., N)."""
    return np.asarray((f @ w[..., None])[..., 0])


def _log(f: Floats) -> Floats:
    """log, -inf where f is 0."""
    with np.errstate(divide='ignore'):
        return np.log(f)

"""The models that a configuration of system C asks for."""

from __future__ import annotations

from wsn_tracking.filters.adaptive import Kld
from wsn_tracking.filters.link_offsets import Drift
from wsn_tracking.models import walk
from wsn_tracking.models.anchors import Anchors
from wsn_tracking.models.body import Curve, Curves, about_anchors
from wsn_tracking.sensing.channel import Body
from wsn_tracking.trackers.human_config import HumanConfig


def curves_of(config: HumanConfig, anchors: Anchors, body: Body | None = None) -> Curves:
    """The channel of every node, (N,); body: as `calibrate --body` found it, about each node's own path loss."""
    c = config.signal
    given = Curves(Curve(*c.los), Curve(*c.nlos), Curve(*c.single))
    chosen = about_anchors(given, anchors) if c.curves == 'anchors' else given
    if c.curves == 'anchors' and body is not None:
        chosen = with_body(chosen, body)
    ones = [curve.p_ref + c.body_loss for curve in chosen], [curve.k for curve in chosen]
    return Curves(*(Curve(p + 0.0 * anchors.n, k + 0.0 * anchors.n) for p, k in zip(*ones, strict=True)))


def with_body(curves: Curves, body: Body) -> Curves:
    """The body that was found in the place of the usual one; where its sides are not known, it shifts all curves."""
    loss, own = float(body.loss.value[0]), curves.single
    if body.los is None or body.nlos is None:
        return Curves(*(Curve(curve.p_ref + loss, curve.k) for curve in curves))
    los, nlos = (Curve(own.p_ref + at, own.k + per_decade) for at, per_decade in (body.los.value, body.nlos.value))
    return Curves(los, nlos, Curve(own.p_ref + loss, own.k))


def walk_of(config: HumanConfig) -> walk.Walk:
    """The model of legs and pauses; of a motion without them: always walking, facing where it steps."""
    m = config.motion
    if config.motion_kind != 'walk':
        return walk.Walk(v_min=0.0, v_max=0.0, pause_s=0.0, yaw_std=0.0)
    return walk.Walk(
        m.slowest,
        m.fastest,
        m.walk_time,
        m.pause_time,
        m.turn_time,
        m.heading_noise,
        m.speed_noise,
        m.position_noise,
        m.yaw,
        m.yaw_time,
    )


def transition_of(config: HumanConfig) -> walk.Transition:
    """How particles move."""
    if config.motion_kind == 'disc':
        return walk.disc(walk.Disc(config.v_max))
    if config.motion_kind == 'random_walk':
        return walk.random_walk(walk.RandomWalk(config.motion.step, config.kernel.kind in ('soft', 'direction')))
    return walk.walk(walk_of(config))


def kld_of(config: HumanConfig) -> Kld | None:
    """How the number of particles follows what is known; None: it does not."""
    r = config.resampling
    return Kld(r.kld, r.kld_cell, least=r.kld_least, most=r.kld_most) if r.kld else None


def drift_of(config: HumanConfig) -> Drift | None:
    """How the links' offsets drift; None: they have none."""
    return Drift(config.signal.offset_std, config.signal.offset_time) if config.signal.offset_std else None

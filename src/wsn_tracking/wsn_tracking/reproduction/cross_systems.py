"""The five systems and what they are measured against, each as: a recording in, estimates and what was sent out."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

from wsn_tracking import graphs
from wsn_tracking.evaluation.baselines import Fix, Memoryless, Nearest
from wsn_tracking.evaluation.consensus_runs import HEADER, ITEM, SHARE, traffic
from wsn_tracking.evaluation.run import Run
from wsn_tracking.evaluation.run_trackers import run_trackers
from wsn_tracking.graphs.consensus import ConsensusPlan
from wsn_tracking.graphs.plans import configuration_of
from wsn_tracking.node_parameters.consensus import ConsensusNodeConfig
from wsn_tracking.offline import run_plan
from wsn_tracking.parameters import Values, build
from wsn_tracking.reproduction.cross_fields import Facts, Opened, without_bodies
from wsn_tracking.sensing.values import Range, RangeBearing, Rssi


class Sent(NamedTuple):
    """What goes through the air in a whole recording, by the nominal model of docs/consensus.md."""

    messages: float
    bytes: float


class Outcome(NamedTuple):
    """What a system made of a recording."""

    run: Run
    outputs: tuple[str, ...]  # those that are scored
    sent: Sent


class Contender(NamedTuple):
    """One system, or a baseline."""

    name: str
    what: str
    follow: Callable[[Opened, Facts, int, int], Outcome]  # recording, facts, target, seed


def told(system: str, source: graphs.Source, facts: Facts) -> Values:
    """The parameters of a system that follow from the facts alone."""
    S, period = facts.spectral_density, float(source.metadata['period'])
    x_min, y_min, x_max, y_max = source.area
    if system == 'random_q':
        return {
            'input': source.entry_level,
            'noise.kind': 'acceleration',
            'noise.spectral_density': S,
            'update.range_std': facts.range_std,
            'start.speed': facts.speed,
            'robust.dof': facts.dof,
        }
    if system == 'consensus':
        return {
            'rounds': facts.rounds,
            'radius': facts.radius,
            'spectral_density': S,
            'arrival.r_max': math.hypot(x_max - x_min, y_max - y_min),
            'arrival.repair_rate': 0.9,
            'observation.range_std': facts.range_std,
            'prior.mean': [0.5 * (x_min + x_max), 0.5 * (y_min + y_max), 0.0, 0.0],
            'prior.std': [0.3 * (x_max - x_min), 0.3 * (y_max - y_min), facts.speed, facts.speed],
        }
    if system == 'human':
        walks = {'motion.slowest': 0.5 * facts.speed, 'motion.fastest': 1.5 * facts.speed}
        noise = {'motion.speed_noise': 0.25 * facts.speed, 'motion.position_noise': 0.1 * facts.speed}
        body = {} if facts.person else {'signal.kind': 'single', 'signal.least_distance': 0.01}
        return {**walks, **noise, **body, 'signal.dof': facts.dof}
    if system == 'hybrid':
        return {
            'period': period,
            'range_std': facts.range_std,
            'motion.spectral_density': S,
            'models.spectral_density': S,
            'start.window': max(0.5, 3.0 * period),
            'start.velocity_std': facts.speed,
            'robust.dof': facts.dof,
        }
    return {
        'turn.acceleration_std': math.sqrt(S / period),
        'turn.turn_std': facts.turn,
        'update.range_std': facts.range_std,
        'start.speed': facts.speed,
        'start.turn': facts.turn,
    }


def measured(opened: Opened, target: int) -> int:
    """Messages of nodes that tell what they heard of a target."""
    kinds = (Rssi, Range, RangeBearing)
    return sum(isinstance(m, kinds) and m.target_id == target for m in opened[1].messages)


def to_a_centre(opened: Opened, target: int) -> Sent:
    """Every measurement goes to one place."""
    count = measured(opened, target)
    return Sent(count, (HEADER + ITEM) * float(count))


DOCUMENT_A: Values = {  # what its stack is not, wherever a configuration says otherwise
    'update.kind': 'ckf',
    'update.r': 'measured',
    'update.kappa': 0.0,
    'robust.dof': 0.0,
    'robust.offset_std': 0.0,
}
CENTRE: Values = {'peers': [1], 'noise.q_min': 7.0, 'noise.q_max': 7.0, 'update.kind': 'iplf'}


def plan_of(system: str, opened: Opened, facts: Facts, target: int, more: Values, own: bool = True) -> graphs.Plan:
    """A system with the configuration that is made for the recording, if there is one; else the facts tell it all.

    `own`: the configuration of the system's document counts as one on the scenario of that document.
    """
    source, recording = opened
    chosen = configuration_of(system, source)
    made = chosen != system or (own and source.metadata.get('configuration') == system)
    settings = {**({} if made else told(system, source, facts)), **more}
    (plan,) = graphs.plans_of(source, recording.anchors, system, chosen, settings, target)
    return plan


def random_q(opened: Opened, facts: Facts, target: int, seed: int) -> Outcome:
    """A: three estimators that tell each other what they think, behind the trigger where there is one."""
    opened = bodiless(opened, facts)
    run = run_plan(plan_of('random_q', opened, facts, target, {**DOCUMENT_A, 'seed': seed}), opened[1])
    triggered = run.reports and opened[0].entry_level == 'rssi'
    heard = float(sum(len(r.sent_ids) for r in run.reports) if triggered else measured(opened, target))
    shared = 3.0 * run.epochs
    return Outcome(run, ('fused_1',), Sent(heard + shared, (HEADER + ITEM) * heard + (HEADER + SHARE) * shared))


def consensus(opened: Opened, facts: Facts, target: int, seed: int) -> Outcome:
    """B: every node tells its neighbours; `seed` draws nothing."""
    opened = bodiless(opened, facts)
    plan = plan_of('consensus', opened, facts, target, {})
    assert isinstance(plan, ConsensusPlan)  # of this system
    run = run_plan(plan, opened[1])
    each = traffic(build(ConsensusNodeConfig, plan.values), opened[1].anchors.positions)
    times = float(run.epochs * len(opened[0].ids))
    return Outcome(run, tuple(plan.outputs), Sent(each.messages * times, each.bytes_nominal * times))


def single(system: str, more: Values, opened: Opened, facts: Facts, target: int, seed: int) -> Outcome:
    """C, D or E: one tracker that is told everything."""
    given = opened if system == 'human' else bodiless(opened, facts)
    plan = plan_of(system, given, facts, target, {**more, **({'seed': seed} if system == 'human' else {})})
    return Outcome(run_plan(plan, given[1]), tuple(plan.outputs)[:1], to_a_centre(opened, target))


def centre(opened: Opened, facts: Facts, target: int, seed: int) -> Outcome:
    """One iterated filter that is told everything, with white acceleration; `seed` draws nothing."""
    opened = bodiless(opened, facts)
    run = run_plan(plan_of('random_q', opened, facts, target, CENTRE, own=False), opened[1])
    return Outcome(run, ('local_1',), to_a_centre(opened, target))


def naive(kind: type[Memoryless], opened: Opened, facts: Facts, target: int, seed: int) -> Outcome:
    """Without any memory; `seed` draws nothing."""
    source, recording = opened
    tracker = kind(recording.anchors, float(source.metadata['target_height']))
    return Outcome(run_trackers(recording, {target: tracker}), tracker.outputs, to_a_centre(opened, target))


def bodiless(opened: Opened, facts: Facts) -> Opened:
    """What a filter is given that knows no bodies."""
    source, recording = opened
    return source, without_bodies(recording, facts.sigma_db) if facts.sigma_db else recording


PAPER_C: Values = {'profile': 'paper_max', 'lag': 0.0}
CONTENDERS = (
    Contender('A', "the document's: three random-q cubature filters, fused by CI", random_q),
    Contender('centre', 'one iterated cubature filter that is told everything: what is better than A', centre),
    Contender('B', 'consensus by flooding, a filter in every node', consensus),
    Contender('C', 'particle filter, improved', partial(single, 'human', {'lag': 0.0})),
    Contender('C, document', "the document's: two curves, steps within a disc", partial(single, 'human', PAPER_C)),
    Contender('D', "the document's: least squares and EKF", partial(single, 'hybrid', {'form': 'inflate'})),
    Contender('D, two models', 'two motion models at once', partial(single, 'hybrid', {'form': 'imm'})),
    Contender('E', "the document's: cubature filter of turns", partial(single, 'loss_tolerant', {})),
    Contender('E, EKF', 'the extended filter in its place', partial(single, 'loss_tolerant', {'filter': 'ekf'})),
    Contender('fix', 'naive: least squares of the epoch alone', partial(naive, Fix)),
    Contender('nearest', 'naive: the place of the node that hears best', partial(naive, Nearest)),
)

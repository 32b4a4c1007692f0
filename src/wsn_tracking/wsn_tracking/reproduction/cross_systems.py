"""The five systems and what they are measured against, each as: a recording in, estimates and what was sent out."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

from wsn_tracking import graphs
from wsn_tracking.evaluation.run import Run
from wsn_tracking.evaluation.run_trackers import run_trackers
from wsn_tracking.graphs.consensus import ConsensusPlan
from wsn_tracking.graphs.facts import Facts, told
from wsn_tracking.graphs.plans import configuration_of, is_made_for
from wsn_tracking.node_parameters.consensus import ConsensusNodeConfig
from wsn_tracking.offline import run_plan
from wsn_tracking.parameters import Values, build
from wsn_tracking.reproduction.cross_baselines import Fix, Memoryless, Nearest
from wsn_tracking.reproduction.cross_fields import Opened, without_bodies
from wsn_tracking.sensing.values import Range, RangeBearing, Rssi
from wsn_tracking.studies.consensus_runs import HEADER, ITEM, SHARE, traffic


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
    made = chosen != system or (own and is_made_for(chosen, system, source))
    settings = {**({} if made else told(system, source, recording.anchors, facts)), **more}
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
    """D or E: one tracker that is told everything; `seed` draws nothing."""
    opened = bodiless(opened, facts)
    plan = plan_of(system, opened, facts, target, more)
    return Outcome(run_plan(plan, opened[1]), tuple(plan.outputs)[:1], to_a_centre(opened, target))


def human(profile: str, opened: Opened, facts: Facts, target: int, seed: int) -> Outcome:
    """C: the same with particles, which know a body."""
    more: dict[str, Any] = {'profile': profile, 'lag': 0.0, 'seed': seed}
    if profile != 'improved':
        more['motion.v_max'] = 4.0 * facts.speed  # of its disc, as for the walks of its document
    if opened[0].entry_level == 'range':
        more['start.reset_nodes'] = 1  # where nodes range one at a time, an epoch never surprises three of them
    plan = plan_of('human', opened, facts, target, more)
    return Outcome(run_plan(plan, opened[1]), ('human',), to_a_centre(opened, target))


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


CONTENDERS = (
    Contender('A', "the document's: three random-q cubature filters, fused by CI", random_q),
    Contender('centre', 'one iterated cubature filter that is told everything: what is better than A', centre),
    Contender('B', 'consensus by flooding, a filter in every node', consensus),
    Contender('C', 'particle filter, improved', partial(human, 'improved')),
    Contender('C, document', "the document's: two curves, steps within a disc", partial(human, 'paper_max')),
    Contender('D', "the document's: least squares and EKF", partial(single, 'hybrid', {'form': 'inflate'})),
    Contender('D, two models', 'two motion models at once', partial(single, 'hybrid', {'form': 'imm'})),
    Contender('E', "the document's: cubature filter of turns", partial(single, 'loss_tolerant', {})),
    Contender('E, EKF', 'the extended filter in its place', partial(single, 'loss_tolerant', {'filter': 'ekf'})),
    Contender('fix', 'naive: least squares of the epoch alone', partial(naive, Fix)),
    Contender('nearest', 'naive: the place of the node that hears best', partial(naive, Nearest)),
)

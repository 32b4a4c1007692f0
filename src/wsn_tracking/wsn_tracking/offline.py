"""The plans of a graph without its processes."""

from __future__ import annotations

from wsn_tracking.evaluation.run import Progress, Run, merged, silent
from wsn_tracking.evaluation.run_consensus import run_consensus
from wsn_tracking.evaluation.run_random_q import Sensing, run_random_q
from wsn_tracking.evaluation.run_trackers import run_trackers
from wsn_tracking.graphs.consensus import ConsensusPlan
from wsn_tracking.graphs.parts import Plan, Source
from wsn_tracking.graphs.plans import plans_of
from wsn_tracking.graphs.random_q import RandomQPlan
from wsn_tracking.graphs.single import SinglePlan
from wsn_tracking.node_parameters.consensus import ConsensusNodeConfig
from wsn_tracking.node_parameters.estimator import EstimatorNodeConfig
from wsn_tracking.node_parameters.sensing import SensingNodeConfig
from wsn_tracking.parameters import Values, build
from wsn_tracking.sensing.recording import Recording, of_target


def offline(
    source: Source,
    recording: Recording,
    configuration: str = '',
    settings: Values | None = None,
    target_id: int = -1,
    progress: Progress = silent,
    trackers: str = '',
) -> Run:
    """What the graph of these plans publishes, computed in this process."""
    plans = plans_of(source, recording.anchors, trackers, configuration, settings, target_id)
    return merged([run_plan(plan, recording, progress) for plan in plans])


def run_plan(plan: Plan, recording: Recording, progress: Progress = silent) -> Run:
    """What the nodes of one system publish."""
    if isinstance(plan, ConsensusPlan):
        node = build(ConsensusNodeConfig, plan.values)
        return run_consensus(of_target(recording, plan.target_id), node, plan.target_id, progress=progress)
    if isinstance(plan, RandomQPlan):
        estimators = [build(EstimatorNodeConfig, values) for values in plan.estimators]
        own = of_target(recording, plan.target_id)
        return run_random_q(own, _sensing(plan), estimators, plan.target_id, progress)
    assert isinstance(plan, SinglePlan)
    config = plan.config
    trackers = {target: config.tracker(recording.anchors, target) for target in plan.targets}
    return run_trackers(recording, trackers, progress)


def _sensing(plan: RandomQPlan) -> Sensing | None:
    if plan.sensing is None:
        return None
    config = build(SensingNodeConfig, plan.sensing)
    return Sensing(config.trigger, config.seed, config.channel)

"""The plan of a graph without its processes."""

from __future__ import annotations

from wsn_tracking import graphs
from wsn_tracking.configuration import Values
from wsn_tracking.evaluation.run import Progress, Run, Sensing, run_random_q, silent
from wsn_tracking.evaluation.run_consensus import run_consensus
from wsn_tracking.node_parameters.consensus import ConsensusNodeConfig
from wsn_tracking.node_parameters.estimator import EstimatorNodeConfig
from wsn_tracking.node_parameters.sensing import SensingNodeConfig
from wsn_tracking.parameters import build
from wsn_tracking.sensing.recording import Recording, of_target


def offline(
    source: graphs.Source,
    recording: Recording,
    configuration: str = '',
    settings: Values | None = None,
    target_id: int = -1,
    progress: Progress = silent,
    trackers: str = '',
) -> Run:
    """What the graph of this plan publishes, computed in this process."""
    plan = graphs.plan_of(source, recording, trackers, configuration, settings, target_id)
    if isinstance(plan, graphs.ConsensusPlan):
        node = build(ConsensusNodeConfig, plan.values)
        return run_consensus(of_target(recording, plan.target_id), node, plan.target_id, progress=progress)
    estimators = [build(EstimatorNodeConfig, values) for values in plan.estimators]
    sensing = None
    if plan.sensing is not None:
        config = build(SensingNodeConfig, plan.sensing)
        sensing = Sensing(config.trigger, config.seed, config.channel)
    return run_random_q(of_target(recording, plan.target_id), sensing, estimators, plan.target_id, progress)

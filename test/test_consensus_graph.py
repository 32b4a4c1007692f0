"""System B as running processes: equal to the evaluation, and a network that bears the death of some of its nodes."""

from __future__ import annotations

import numpy as np
import pytest
from wsn_tracking_msgs.msg import TargetEstimate

import live
from observer import observing
from wsn_tracking import graphs
from wsn_tracking.bags.estimates import read_estimates
from wsn_tracking.bags.save import save
from wsn_tracking.graphs_consensus import consensus_graph, plan_consensus
from wsn_tracking.nodes import qos
from wsn_tracking.offline import offline
from wsn_tracking.simulation.b_field import FieldConfig, b_field
from wsn_tracking.simulation.record import record

TIMEOUT = 60.0  # [s]


def bag_of(folder, epochs):
    """A bag of a field of ten nodes."""
    path = folder / 'field'
    save(path, record(b_field(FieldConfig(nodes=10, width=150.0, depth=180.0, epochs=epochs)), 3))
    return path


def halves(bag, *, settings=None, record=None, rate=0.0):
    """The graph of a bag with the nodes in two processes."""
    source, recording = graphs.open_bag(str(bag))
    plan = plan_consensus(source, recording.anchors, settings=settings, processes=2)
    assert [len(district) for district in plan.districts] == [5, 5]
    feed = graphs.Process('bag_player_node', 'bag_player', {'bag': str(bag), 'rate': rate})
    return plan, consensus_graph(source, plan, feed, replay=True, settings=settings, evaluator={}, record=record)


@pytest.mark.parametrize('scheme', ['icf', 'flood'])
def test_graph_equals_evaluation(tmp_path, scheme):
    """Ten nodes in two processes give what they compute without any middleware, number by number."""
    bag, settings = bag_of(tmp_path, 12), {'scheme': scheme, 'rounds': 5}
    plan, graph = halves(
        bag,
        settings=settings,
        record={
            'output': str(tmp_path / 'out'),
            'extra_topics': [f'estimate/consensus_{i}' for i in range(1, 11)],
        },
    )
    run = offline(*graphs.open_bag(str(bag)), settings=settings)
    with live.private_domain() as environment, live.started(graph, environment) as running:
        outputs = live.wait_all(running, ['bag_player', 'evaluator', 'bag_recorder'], TIMEOUT)
    assert 'dropped    nothing' in outputs['evaluator']
    published = read_estimates(tmp_path / 'out')
    assert set(published) == set(run.estimates) == set(plan.outputs)
    for name, estimates in published.items():
        assert [e.request_seq for e in estimates] == list(range(12))
        for seen, computed in zip(estimates, run.estimates[name], strict=True):
            np.testing.assert_allclose(seen.mean, computed.mean, rtol=0.0, atol=1e-9)
            np.testing.assert_allclose(seen.covariance, computed.covariance, rtol=0.0, atol=1e-9)
            assert (seen.contributors, seen.measurements) == (computed.contributors, computed.measurements)


@pytest.mark.parametrize('scheme', ['icf', 'flood'])
def test_neighbours_of_a_killed_process_go_on_and_it_rejoins_within_3_epochs(tmp_path, scheme):
    """SIGKILL in mid-run, and started anew: the others never miss an epoch, and count its nodes again."""
    timing = {'lossless': False, 'loss_timeout': 0.25, 'round_timeout': 0.06, 'output_timeout': 1.0}  # of T = 0.5 s
    settings = {'scheme': scheme, 'rounds': 5, **timing}
    plan, graph = halves(bag_of(tmp_path, 60), settings=settings, rate=2.0)
    survivors, victims = plan.districts
    processes = {p.name: p for p in graph}
    with (
        live.private_domain() as environment,
        observing(environment) as observer,
        live.started(graph, environment) as running,
    ):
        seen = observer.collect(TargetEstimate, f'estimate/consensus_{survivors[0]}', qos.ESTIMATES)
        theirs = observer.collect(TargetEstimate, f'estimate/consensus_{victims[0]}', qos.ESTIMATES)
        observer.until(lambda: len(seen) > 5 and len(theirs) > 5, TIMEOUT, 'five epochs')
        assert set(seen[-1].contributors) == {*survivors, *victims}
        running['consensus_nodes_2'].kill()
        observer.until(lambda: list(seen[-1].contributors) == list(survivors), TIMEOUT, 'the survivors alone')
        before = len(theirs)
        running['again'] = live.start(processes['consensus_nodes_2'], environment, tmp_path)
        observer.until(lambda: len(theirs) > before, TIMEOUT, 'an estimate of the one that came back')
        back = theirs[before].request_seq
        observer.until(lambda: seen[-1].request_seq >= back + 4, TIMEOUT, 'four epochs more')
    of = {e.request_seq: e for e in seen}
    assert sorted(of) == list(range(seen[0].request_seq, seen[-1].request_seq + 1))
    assert set(of[back + 3].contributors) == {*survivors, *victims}
    one, other = of[back + 3], next(e for e in theirs if e.request_seq == back + 3)
    assert np.hypot(one.mean[0] - other.mean[0], one.mean[1] - other.mean[1]) < 1.0

"""System B as running processes: equal to the evaluation, and a network that bears the death of some of its nodes."""

from __future__ import annotations

import numpy as np
import pytest
from std_msgs.msg import String
from wsn_tracking_msgs.msg import TargetEstimate

import live
from observer import observing
from wsn_tracking import graphs
from wsn_tracking.bags.estimates import read_estimates
from wsn_tracking.bags.save import save
from wsn_tracking.configuration import load_configuration
from wsn_tracking.graphs.consensus import plan_consensus
from wsn_tracking.nodes import qos
from wsn_tracking.offline import offline
from wsn_tracking.simulation.b_field import FieldConfig, b_field
from wsn_tracking.simulation.record import record

TIMEOUT = 180.0  # [s] on a machine that does much else


def bag_of(folder, epochs):
    """A bag of a field of ten nodes."""
    path = folder / 'field'
    save(path, record(b_field(FieldConfig(nodes=10, width=150.0, depth=180.0, epochs=epochs)), 3))
    return path


def halves(bag, *, settings=None, record=None, rate=0.0):
    """The graph of a bag with the nodes in two processes."""
    source, recording = graphs.open_bag(str(bag))
    plan = plan_consensus(source, recording.anchors, load_configuration('consensus'), settings, processes=2)
    assert [len(district) for district in plan.districts] == [5, 5]
    feed = graphs.Process('bag_player_node', 'bag_player', {'bag': str(bag), 'rate': rate})
    how = graphs.How(replay=True, settings=settings or {})
    return plan, graphs.complete(source, [plan], feed, how, evaluator={}, record=record)


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


def apart(one, other):
    """Distance of two estimates' positions, squared, in units of what they claim to know; of two states at most 14."""
    spread = np.array([np.reshape(e.covariance, (4, 4))[:2, :2] for e in (one, other)]).sum(axis=0)
    difference = np.subtract(one.mean[:2], other.mean[:2])
    return float(difference @ np.linalg.solve(spread, difference))


@pytest.mark.parametrize('scheme', ['icf', 'flood'])
def test_neighbours_of_a_killed_process_go_on_and_it_rejoins_within_3_epochs(tmp_path, scheme):
    """SIGKILL in mid-run, and started anew: the others never miss an epoch, and count its nodes again.

    Its epochs count from when it is matched with the others, which takes as long as discovery does. The feed does not
    run ahead of the survivors, and a round may last a second: only who is gone is not heard.
    """
    timing = {'lossless': False, 'loss_timeout': 1.0, 'round_timeout': 1.0}
    settings = {'scheme': scheme, 'rounds': 3, **timing}
    plan, graph = halves(bag_of(tmp_path, 150), settings=settings, rate=1.0)
    survivors, victims = plan.districts
    everyone = {*survivors, *victims}
    paced = {'window': 1, 'output_timeout': 5.0}
    graph = tuple(
        p._replace(parameters={**p.parameters, **paced}) if p.executable == 'bag_player_node' else p for p in graph
    )
    with (
        live.private_domain() as environment,
        observing(environment) as observer,
        live.started(graph, environment) as running,
    ):
        ready = observer.collect(String, 'ready', qos.LATCHED)
        seen = observer.collect(TargetEstimate, f'estimate/consensus_{survivors[0]}', qos.ESTIMATES)
        theirs = observer.collect(TargetEstimate, f'estimate/consensus_{victims[0]}', qos.ESTIMATES)

        def alone():
            return sum(list(e.contributors) == list(survivors) for e in seen)

        def times_ready():
            return sum(message.data == 'consensus_nodes_2' for message in ready)

        observer.until(lambda: bool(seen) and set(seen[-1].contributors) == everyone, TIMEOUT, 'all contributing')
        running['consensus_nodes_2'].kill()
        observer.until(lambda: alone() > plan.values['silent_epochs'], TIMEOUT, 'survivors that wait for nobody else')
        before, said = len(theirs), times_ready()
        process = next(p for p in graph if p.name == 'consensus_nodes_2')
        running['again'] = live.start(process, environment, tmp_path)
        observer.until(lambda: times_ready() > said, TIMEOUT, 'it to be ready')
        back = seen[-1].request_seq + 1  # the epoch within which it is, at the latest

        def pairs():
            """Estimates of both in the epochs since, where both count everyone."""
            ours = {e.request_seq: e for e in seen if set(e.contributors) == everyone}
            return [(ours[e.request_seq], e) for e in theirs[before:] if e.request_seq in ours]

        observer.until(lambda: any(apart(*pair) < 14.0 for pair in pairs()), TIMEOUT, 'that they agree')
        observer.until(lambda: seen[-1].request_seq >= back + 3, TIMEOUT, 'three epochs more')
    of = {e.request_seq: e for e in seen}
    assert sorted(of) == list(range(seen[0].request_seq, seen[-1].request_seq + 1))
    assert any(set(of[k].contributors) == everyone for k in range(back, back + 4))

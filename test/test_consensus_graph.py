"""System B as running processes: equal to the evaluation, and a network that bears the death of some of its nodes."""

from __future__ import annotations

import json
from itertools import combinations

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
from wsn_tracking.sensing.values import RangeBearing
from wsn_tracking.simulation.b_field import FieldConfig, b_field
from wsn_tracking.simulation.record import record


def bag_of(folder, epochs):
    """A bag of a field of ten nodes; in its third epoch a node speaks that nobody knows."""
    path = folder / 'field'
    recording = record(b_field(FieldConfig(nodes=10, width=150.0, depth=180.0, epochs=epochs)), 3)
    at = next(k for k, m in enumerate(recording.messages) if isinstance(m, RangeBearing) and m.request_seq == 2)
    stranger = recording.messages[at]._replace(node_id=99)
    save(path, recording._replace(messages=(*recording.messages[:at], stranger, *recording.messages[at:])))
    return path


def halves(bag, *, settings=None, record=None, evaluator=None, rate=0.0):
    """The graph of a bag with the nodes in two processes."""
    source, recording = graphs.open_bag(str(bag))
    plan = plan_consensus(source, recording.anchors, load_configuration('consensus'), settings, processes=2)
    assert [len(district) for district in plan.districts] == [5, 5]
    feed = graphs.Process('bag_player_node', 'bag_player', {'bag': str(bag), 'rate': rate})
    how = graphs.How(replay=True, settings=settings or {})
    return plan, graphs.complete(source, [plan], feed, how, evaluator=evaluator or {}, record=record)


@pytest.fixture
def through_graph(tmp_path):
    """A function: so many epochs through the graph and without it, with these parameters of the nodes."""

    def both(epochs, **settings):
        bag, scores = bag_of(tmp_path, epochs), tmp_path / 'scores.json'
        extra = [f'estimate/consensus_{i}' for i in range(1, 11)]
        record = {'output': str(tmp_path / 'out'), 'extra_topics': extra}
        plan, graph = halves(bag, settings={**live.PATIENT, **settings}, record=record, evaluator={'json': str(scores)})
        run = offline(*graphs.open_bag(str(bag)), settings=settings)
        with live.private_domain() as environment, live.started(graph, environment) as running:
            live.wait_all(running, ['bag_player', 'evaluator', 'bag_recorder'], live.TIMEOUT)
        published = read_estimates(tmp_path / 'out')
        assert set(published) == set(run.estimates) == set(plan.outputs)
        return published, run, json.loads(scores.read_text('utf-8'))['input']

    return both


def check_equal(published, run):
    """To the last bit, epoch by epoch."""
    for name, estimates in published.items():
        assert [e.request_seq for e in estimates] == list(range(run.epochs))
        for seen, computed in zip(estimates, run.estimates[name], strict=True):
            np.testing.assert_array_equal(seen.mean, computed.mean)
            np.testing.assert_array_equal(seen.covariance, computed.covariance)
            assert (seen.contributors, seen.measurements) == (computed.contributors, computed.measurements)


def rmse(tmp_path, estimates):
    """Of all nodes from epoch 5 on [m]."""
    truth = graphs.open_bag(str(tmp_path / 'field'))[1].truth[1].positions[:, :2]
    kept = [e for track in estimates.values() for e in track if e.request_seq >= 5]
    return np.sqrt(np.mean([np.sum((e.mean[:2] - truth[e.request_seq]) ** 2) for e in kept]))


@pytest.mark.parametrize('scheme', ['icf', 'flood'])
def test_graph_equals_evaluation(through_graph, scheme):
    """Ten nodes in two processes give what they compute without any middleware."""
    published, run, dropped = through_graph(12, scheme=scheme, rounds=5)
    check_equal(published, run)
    assert run.dropped == dropped == {'unknown_node': 1}  # though both processes have seen it


def test_a_third_of_the_shares_may_be_lost_live(through_graph, tmp_path):
    """Losses are drawn by seed, epoch, round, sender and receiver: the graph loses what the evaluation does."""
    published, run, dropped = through_graph(20, **{'scheme': 'icf', 'rounds': 5, 'link.loss': 0.3, 'link.seed': 1})
    check_equal(published, run)
    assert dropped == run.dropped
    assert set(dropped) == {'lost_share', 'unknown_node'}
    whole = offline(*graphs.open_bag(str(tmp_path / 'field')), settings={'scheme': 'icf', 'rounds': 5})
    assert rmse(tmp_path, published) <= 1.3 * rmse(tmp_path, whole.estimates)


@pytest.mark.parametrize('scheme', ['icf', 'flood'])
def test_halves_of_a_running_network_part_meet_and_agree_again(through_graph, tmp_path, scheme):
    """From epoch 5 to 11 nothing passes x = 75 m. The halves do not wait for each other then, and run apart in time.

    They are at most as far apart as the feed runs ahead, four epochs; shares that come as late as that still tell that
    the others live, who count from the next epoch on.
    """
    cut = {'link.cut_at': 75.0, 'link.cut_from': 5, 'link.cut_until': 12}
    published, _, dropped = through_graph(26, **{'scheme': scheme, 'rounds': 5, **cut})
    assert dropped['cut_share'] > 0
    anchors = graphs.open_bag(str(tmp_path / 'field'))[1].anchors
    west = {int(i) for i, x in zip(anchors.ids, anchors.positions[:, 0], strict=True) if x < 75.0}
    everyone = set(anchors.ids.tolist())
    assert 0 < len(west) < len(everyone)
    for name, estimates in published.items():
        side = west if int(name.rpartition('_')[2]) in west else everyone - west
        assert all(set(e.contributors) == side for e in estimates[5:12])
        assert all(set(e.contributors) == everyone for e in (*estimates[:5], *estimates[20:]))
    for k in range(20, 26):
        together = [estimates[k] for estimates in published.values()]
        assert max(apart(one, other) for one, other in combinations(together, 2)) < 14.0


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

        observer.until(lambda: bool(seen) and set(seen[-1].contributors) == everyone, live.TIMEOUT, 'all contributing')
        running['consensus_nodes_2'].kill()
        observer.until(
            lambda: alone() > plan.values['silent_epochs'], live.TIMEOUT, 'survivors that wait for nobody else'
        )
        before, said = len(theirs), times_ready()
        process = next(p for p in graph if p.name == 'consensus_nodes_2')
        running['again'] = live.start(process, environment, tmp_path)
        observer.until(lambda: times_ready() > said, live.TIMEOUT, 'it to be ready')
        back = seen[-1].request_seq + 1  # the epoch within which it is, at the latest

        def pairs():
            """Estimates of both in the epochs since, where both count everyone."""
            ours = {e.request_seq: e for e in seen if set(e.contributors) == everyone}
            return [(ours[e.request_seq], e) for e in theirs[before:] if e.request_seq in ours]

        observer.until(lambda: any(apart(*pair) < 14.0 for pair in pairs()), live.TIMEOUT, 'that they agree')
        observer.until(lambda: seen[-1].request_seq >= back + 3, live.TIMEOUT, 'three epochs more')
    of = {e.request_seq: e for e in seen}
    assert sorted(of) == list(range(seen[0].request_seq, seen[-1].request_seq + 1))
    assert any(set(of[k].contributors) == everyone for k in range(back, back + 4))

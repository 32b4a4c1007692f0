"""Between the processes of a graph: topics that somebody gives, partners that are right, settings that arrive."""

from __future__ import annotations

from collections import Counter

import pytest
from plan_cases import BAGS, by_name, graph, planned, source

from wsn_tracking.bags.playback import playback
from wsn_tracking.node_parameters.common import NodeConfig
from wsn_tracking.node_parameters.executables import EXECUTABLES
from wsn_tracking.parameters import build
from wsn_tracking.processes import declared


def partners(parameter):
    return {topic: int(count) for topic, _, count in (entry.rpartition('=') for entry in parameter if entry)}


@pytest.mark.parametrize('bag', sorted(BAGS))
@pytest.mark.parametrize('each', [False, True])
@pytest.mark.parametrize('recorded', [False, True])
def test_whatever_is_expected_is_there(bag, each, recorded):
    """Nobody waits for a partner that does not exist; counts are those of the topics' other side."""
    s = source(BAGS[bag])
    record = {'output': 'y', 'extra_topics': ['estimate/fused_1']} if recorded else None
    plan = planned(s)
    processes = graph(s, plan, evaluator={}, record=record, one_process_each=each)
    sent = {'anchors', 'request', 'epoch_end', *(event.topic for event in playback(BAGS[bag]).events)}
    assert set(by_name(processes)['bag_player'].gives) == sent  # what the feed opens is what it says it gives
    gives = Counter(topic for p in processes for topic in p.gives)
    takes = Counter(topic for p in processes for topic in p.takes)
    for p in processes:
        expected = partners(p.parameters['expected_publishers'])
        assert expected == {topic: gives[topic] for topic in p.takes if gives[topic]}
        expected = partners(p.parameters['expected_subscribers'])
        assert expected == {topic: takes[topic] for topic in p.gives if takes[topic]}
        necessary = set(p.takes) - {'trigger_report', f'truth/target_{plan.target_id}'}
        assert necessary <= set(gives), p.name
        assert len(set(p.takes)) == len(p.takes)
        assert len(set(p.gives)) == len(p.gives)
    senders = [p.name for p in processes if 'range' in p.gives]
    assert len(senders) == (1 if bag.startswith('range') or not each else 12)
    assert gives['estimate/local_2'] == gives['estimate/fused_2'] == 1


@pytest.mark.parametrize('bag', sorted(BAGS))
def test_every_parameter_of_every_process_is_right(bag):
    s = source(BAGS[bag])
    for p in graph(s, evaluator={'skip': 2.0}, record={'output': 'y'}, one_process_each=True, markers=True):
        build(EXECUTABLES[p.executable], p.parameters)
        build(NodeConfig, p.parameters)


def test_the_feed_waits_for_all_and_stays_close_to_the_fused_outputs():
    processes = by_name(graph(source(), evaluator={}, record={'output': 'y'}, one_process_each=True))
    feed = processes['bag_player'].parameters
    assert set(feed['expected_nodes']) == set(processes) - {'bag_player'}
    assert feed['window_topics'] == ['estimate/fused_1=1', 'estimate/fused_2=1', 'estimate/fused_3=1']
    assert processes['bag_player'].takes == ('estimate/fused_1', 'estimate/fused_2', 'estimate/fused_3')
    assert {f'sensing_{node}' for node in range(1, 13)} <= set(processes)
    assert processes['sensing_7'].parameters['ids'] == [7]
    together = by_name(graph(source(), evaluator={}))
    assert together['sensing'].parameters['ids'] == list(range(1, 13))
    assert 'bag_recorder' not in together


def test_who_only_looks_on_is_not_waited_for():
    with_markers = by_name(graph(source(), evaluator={}, markers=True))
    assert with_markers['markers'].takes == ()
    assert 'markers' not in with_markers['bag_player'].parameters['expected_nodes']
    without = by_name(graph(source(), evaluator={}))
    assert all(with_markers[name] == p for name, p in without.items())


def test_the_recorder_writes_what_the_feed_sends():
    s = source(BAGS['two_targets'], scenario='a_loop')
    recorder = by_name(graph(s, record={'output': 'y', 'extra_topics': ['', 'estimate/fused_1']}))['bag_recorder']
    assert {'request', 'rssi', 'epoch_end', 'anchors', 'truth/target_1', 'estimate/fused_1'} == set(recorder.takes)
    assert recorder.parameters['targets'] == [1, 4]
    assert 'scenario=a_loop' in recorder.parameters['metadata']
    assert recorder.parameters['entry_level'] == 'rssi'
    bare = s._replace(metadata={})
    assert by_name(graph(bare, record={}))['bag_recorder'].parameters['metadata'] == ['']


def test_in_replay_nothing_may_be_lost_and_patience_is_a_parameter():
    processes = by_name(graph(source(), settings={'fusion_timeout': 0.3}, evaluator={'skip': 2.0}))
    estimator = processes['estimator_2'].parameters
    assert (estimator['lossless'], estimator['loss_timeout'], estimator['fusion_timeout']) == (True, 20.0, 0.3)
    assert processes['sensing'].parameters['loss_timeout'] == 20.0
    assert processes['evaluator'].parameters['skip'] == 2.0


def test_settings_reach_whoever_knows_them():
    """Of the evaluator the rules that it compares with, of feed and evaluator their patience."""
    given = {'fusion.lci_a': 0.3, 'output_timeout': 2.0, 'window': 9, 'silence': 0.2}
    plan = planned(source(), settings=given)
    processes = by_name(graph(source(), plan, settings=given, evaluator={}, record={}))
    assert declared(processes['evaluator'])['fusion.lci_a'] == 0.3
    assert declared(processes['evaluator'])['output_timeout'] == 2.0
    assert declared(processes['bag_player'])['output_timeout'] == 2.0
    assert declared(processes['bag_player'])['window'] == 9
    assert declared(processes['bag_recorder'])['silence'] == 0.2
    assert declared(processes['bag_player'])['rate'] == 0.0

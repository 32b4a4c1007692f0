"""The graph of system B: who lives with whom, what each process takes and gives, and what is refused."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from graph_cases import a_loop

from wsn_tracking.configuration import load_configuration
from wsn_tracking.errors import TrackingError
from wsn_tracking.graphs import How, Process, complete, plans_of, source_of
from wsn_tracking.graphs.consensus import ConsensusPlan, districts, plan_consensus
from wsn_tracking.graphs.plans import configuration_of, systems_of
from wsn_tracking.node_parameters.common import NodeConfig
from wsn_tracking.node_parameters.consensus import ConsensusNodeConfig
from wsn_tracking.node_parameters.executables import EXECUTABLES
from wsn_tracking.parameters import build
from wsn_tracking.simulation.b_field import FieldConfig, b_field
from wsn_tracking.simulation.record import record

FIELD = record(b_field(FieldConfig(epochs=3)), 0)
SOURCE = source_of('field', FIELD)
FEED = Process('bag_player_node', 'bag_player', {'bag': 'x', 'rate': 0.0})


def planned(configuration='consensus', **options):
    return plan_consensus(SOURCE, FIELD.anchors, load_configuration(configuration), **options)


def graph(plan=None, replay=True, settings=None, one_process_each=False, **options):
    how = How(replay=replay, settings=settings or {}, one_process_each=one_process_each)
    return complete(SOURCE, [plan or planned()], FEED, how, **{'evaluator': {}, **options})


def nodes_of(processes):
    return [p for p in processes if p.executable == 'consensus_node']


@pytest.mark.parametrize('count', [1, 2, 3, 4, 7, 100])
def test_districts_hold_every_node_once_and_are_equal_in_size(count):
    groups = districts(FIELD.anchors, count)
    assert sorted(i for group in groups for i in group) == FIELD.anchors.ids.tolist()
    assert len(groups) == min(count, 50)
    assert max(map(len, groups)) - min(map(len, groups)) <= 2


def test_districts_keep_neighbours_together():
    """Fewer links leave a district than leave groups of ids as they come."""

    def leaving(groups):
        return sum(len(set(near[i]) - set(group)) for group in groups for i in group)

    near, ids = planned().neighbours, FIELD.anchors.ids.tolist()
    assert leaving(planned().districts) < 0.5 * leaving([ids[k::4] for k in range(4)])


def test_fifty_nodes_live_in_four_processes():
    processes = nodes_of(graph())
    assert len(processes) == 4
    assert len(nodes_of(graph(one_process_each=True))) == 50


@pytest.mark.parametrize('each', [False, True])
def test_whatever_is_taken_is_given(each):
    processes = graph(record={'output': 'y'}, one_process_each=each, markers=True)
    gives = Counter(topic for p in processes for topic in p.gives)
    assert max(gives.values()) == 1
    for p in processes:
        assert set(p.takes) <= set(gives), p.name
        assert len(set(p.takes)) == len(p.takes)
        build(EXECUTABLES[p.executable], p.parameters)
        build(NodeConfig, p.parameters)
    feed = processes[-1].parameters
    assert len(feed['window_topics']) == len(nodes_of(processes))  # one of each process: no queue grows
    assert set(feed['expected_nodes']) == {p.name for p in processes} - {'bag_player', 'markers'}


def test_nobody_takes_a_topic_of_its_own():
    for p in nodes_of(graph()):
        assert not set(p.takes) & set(p.gives)


def test_rounds_end_in_time_live_and_wait_in_replay():
    live = build(ConsensusNodeConfig, nodes_of(graph(replay=False))[0].parameters)
    assert live.longest_start + live.longest_round * live.rounds == pytest.approx(0.6)
    assert not live.lossless
    patient = build(ConsensusNodeConfig, nodes_of(graph())[0].parameters)
    assert patient.longest_round * patient.rounds == pytest.approx(20.0)
    assert patient.lossless
    given = build(ConsensusNodeConfig, nodes_of(graph(settings={'round_timeout': 0.2}))[0].parameters)
    assert given.longest_round == 0.2


@pytest.mark.parametrize(
    ('entry_level', 'metadata', 'trackers', 'configuration', 'wanted'),
    [
        ('observation', {}, '', '', ['consensus']),
        ('range', {}, '', '', ['random_q']),
        ('range', {'configuration': 'consensus'}, '', '', ['consensus']),
        ('range', {'configuration': 'loss_tolerant_lias'}, '', '', ['loss_tolerant']),
        ('range', {'configuration': 'random_q'}, '', 'mine/consensus.yaml', ['consensus']),
        ('range', {'configuration': 'mrclam'}, '', 'consensus_mrclam', ['consensus']),
        ('range', {'configuration': 'random_q'}, 'consensus', '', ['consensus']),
        ('observation', {'configuration': 'consensus'}, 'random_q', '', ['random_q']),
        ('rssi', {}, 'loss_tolerant,random_q', '', ['loss_tolerant', 'random_q']),
    ],
)
def test_the_system_is_the_one_asked_for_else_that_of_the_feed(entry_level, metadata, trackers, configuration, wanted):
    source = SOURCE._replace(entry_level=entry_level, metadata=metadata)
    assert list(systems_of(source, trackers, configuration)) == wanted
    assert {'random_q', 'consensus', 'loss_tolerant'} <= set(systems_of(source, 'all'))
    with pytest.raises(TrackingError, match='there is no system `human_`'):
        systems_of(source, 'consensus,human_')


@pytest.mark.parametrize(
    ('named', 'system', 'wanted'),
    [
        ('danis_three', 'random_q', 'danis_three'),
        ('danis_three', 'consensus', 'consensus'),
        ('consensus', 'consensus', 'consensus'),
        ('consensus', 'loss_tolerant', 'loss_tolerant'),
        ('', 'random_q', 'random_q'),
        ('loss_tolerant', 'loss_tolerant', 'loss_tolerant'),
    ],
)
def test_a_system_has_a_configuration_for_every_feed(named, system, wanted):
    assert configuration_of(system, SOURCE._replace(metadata={'configuration': named})) == wanted


def test_signal_strengths_and_ranges_are_taken_as_they_are():
    recording = a_loop(3)
    (plan,) = plans_of(source_of('a_loop', recording), recording.anchors, 'consensus')
    assert isinstance(plan, ConsensusPlan)
    assert plan.values['input'] == 'rssi'
    assert plan.outputs == {f'consensus_{i}': 1 for i in range(1, 13)}


@pytest.mark.parametrize(
    ('settings', 'words'),
    [
        ({'scheme': 'gossip'}, 'scheme'),
        ({'prior.mean': [1.0]}, 'take four numbers each'),
        ({'target_id': 9}, 'has no target 9: expected one of [1]'),
        ({'neighbours': [1, 2]}, 'set `ids` to that node'),
        ({'round_timeout': -1.0}, 'round_timeout'),
    ],
)
def test_wrong_parameters_are_refused_before_anything_starts(settings, words):
    with pytest.raises(TrackingError) as refused:
        planned(settings=settings)
    assert words in str(refused.value)


def test_neighbours_may_be_named_for_a_single_node():
    config = build(ConsensusNodeConfig, {'ids': [3], 'neighbours': [1, 2]})
    assert config.checked().neighbours == (1, 2)


def test_a_round_lasts_by_default_its_part_of_the_period():
    config = build(ConsensusNodeConfig, {'rounds': 5, 'period': 2.0})
    assert config.longest_round == pytest.approx(0.16)
    assert np.isfinite(build(ConsensusNodeConfig, {'rounds': 0}).longest_round)

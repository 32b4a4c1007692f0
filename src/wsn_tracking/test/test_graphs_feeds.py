"""Whole graphs by what feeds them: a bag, a simulated world, a follower."""

from __future__ import annotations

import pytest
from graph_cases import a_loop, with_second_target
from plan_cases import BAGS, by_name, source

from wsn_tracking import graphs
from wsn_tracking.bags.playback import playback
from wsn_tracking.bags.save import save
from wsn_tracking.errors import TrackingError
from wsn_tracking.node_parameters.executables import EXECUTABLES
from wsn_tracking.parameters import build
from wsn_tracking.sensing.recording import of_target


def test_a_bag_is_opened_complete(tmp_path):
    save(tmp_path / 'some_bag', a_loop(3))
    s, recording = graphs.open_bag(str(tmp_path / 'some_bag'))
    assert s == source(recording)
    assert s.topics == ('epoch_end', 'request', 'rssi', 'truth/target_1')
    assert s.area == (0.0, 0.0, 3.6, 2.4)
    assert source(BAGS['no_truth']).topics == ('epoch_end', 'request', 'rssi')


def test_a_replay_plays_the_bag_wherever_it_is_started(tmp_path, monkeypatch):
    save(tmp_path / 'bag', a_loop(3))
    monkeypatch.chdir(tmp_path)
    processes = by_name(graphs.replay('bag', rate=3.0, namespace=None, progress=True, settings={'loss_timeout': 4.0}))
    player = processes['bag_player'].parameters
    assert (player['bag'], player['namespace']) == (str(tmp_path / 'bag'), '')
    assert (player['rate'], player['progress']) == (3.0, True)
    assert processes['estimator_1'].parameters['loss_timeout'] == 4.0
    assert processes['estimator_1'].parameters['lossless'] is True
    assert processes['evaluator'].parameters['title'] == 'bag'


@pytest.mark.parametrize('target_id', [-1, 4])
def test_a_replay_of_one_target_expects_of_the_player_what_it_plays(tmp_path, target_id):
    """A bag of two targets, with a truth of each and one of a target that is never heard."""
    both = with_second_target(a_loop(3))
    truth = both.truth[1]
    save(tmp_path / 'bag', both._replace(truth={i: truth._replace(target_id=i) for i in (1, 4, 9)}))
    processes = by_name(graphs.replay(str(tmp_path / 'bag'), target_id=target_id, record={'output': 'y'}))
    player = processes['bag_player']
    _, recording = graphs.open_bag(str(tmp_path / 'bag'))
    played = playback(of_target(recording, player.parameters['target_id']))
    assert set(player.gives) == {'anchors', 'request', 'epoch_end', *(event.topic for event in played.events)}
    assert {target for target, _ in played.epochs} == {max(target_id, 1)}
    assert f'truth/target_{max(target_id, 1)}' in player.gives
    recorded = {f'truth/target_{target}' for target in processes['bag_recorder'].parameters['targets']}
    assert {topic for topic in player.gives if topic.startswith('truth/')} <= recorded


def test_a_simulation_sends_a_world_into_the_same_graph(tmp_path):
    processes = by_name(graphs.simulation('a_loop', 3, rate=0.0, start_stamp=5.0, record=str(tmp_path / 'out')))
    world = processes['world'].parameters
    assert (world['scenario'], world['seed'], world['rate'], world['start_stamp']) == ('a_loop', 3, 0.0, 5.0)
    assert processes['bag_recorder'].parameters['output'] == str(tmp_path / 'out')
    assert processes['estimator_1'].parameters['lossless'] is False
    assert set(processes) == {
        'world', 'sensing', 'estimator_1', 'estimator_2', 'estimator_3', 'evaluator', 'bag_recorder'
    }  # fmt: skip
    assert 'bag_recorder' not in by_name(graphs.simulation('a_loop'))


def test_a_simulation_takes_parameters_of_its_world_and_of_its_nodes():
    told = ['faults=clutter', 'dead=[7, 9]', 'dead_from=2', 'epochs=3', 'nodes=12', 'width=150.0', 'depth=150.0']
    processes = by_name(graphs.simulation('b_field', 2, scenario_settings=told, settings={'link.loss': 0.3}))
    assert processes['world'].parameters['settings'] == told
    nodes = [p for p in processes.values() if p.executable == 'consensus_node']
    assert sorted(i for p in nodes for i in p.parameters['ids']) == list(range(1, 13))
    assert {p.parameters['link.loss'] for p in nodes} == {0.3}
    with pytest.raises(TrackingError, match='expected one of zero, clutter, absent'):
        graphs.simulation('b_field', scenario_settings=['faults=never'])


def test_the_ring_of_the_follower_is_closed():
    """Sink, bridge, tracker, bridge: every estimate goes down the line, and each knows whom to wait for."""
    processes = by_name(graphs.follower('sink', seed=3, settings={'driven.cells.period': 0.1}, record='y'))
    tracker, bridge, sink = (processes[name] for name in ('hybrid_tracker', 'serial_bridge', 'sink_simulator'))
    outputs = ['estimate/hybrid_target_1', 'estimate/hybrid_target_2']
    assert set(outputs) <= set(tracker.gives)
    assert bridge.parameters['feedback_topics'] == outputs
    assert set(tracker.takes) - {'trigger_report'} <= set(bridge.gives)
    assert bridge.parameters['port'] == sink.parameters['link'] == 'sink'
    assert bridge.parameters['period'] == sink.parameters['driven.cells.period'] == 0.1
    assert set(sink.parameters['expected_nodes']) == set(processes) - {'sink_simulator'}
    assert (sink.parameters['seed'], sink.parameters['driven.on']) == (3, True)
    for p in processes.values():
        build(EXECUTABLES[p.executable], p.parameters)

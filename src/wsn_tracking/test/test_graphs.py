"""What a graph starts: parameters by precedence, topics that somebody gives, partners that are right."""

from __future__ import annotations

from collections import Counter

import pytest
from graph_cases import a_loop, ranged, with_second_target, without_truth

from wsn_tracking import graphs
from wsn_tracking.bags.playback import playback
from wsn_tracking.bags.save import save
from wsn_tracking.configuration import load_configuration
from wsn_tracking.errors import TrackingError
from wsn_tracking.graphs import How, Process, Source, complete, plans_of, source_of
from wsn_tracking.node_parameters.common import NodeConfig
from wsn_tracking.node_parameters.executables import EXECUTABLES
from wsn_tracking.parameters import build
from wsn_tracking.processes import declared
from wsn_tracking.sensing.recording import of_target
from wsn_tracking.sensing.stage import TriggerConfig

FEED = Process('bag_player_node', 'bag_player', {'bag': 'x', 'rate': 0.0})
BAGS = {
    'rssi': a_loop(3),
    'range': ranged(a_loop(3), TriggerConfig(kind='near')),
    'range_without_reports': ranged(a_loop(3), TriggerConfig(kind='near'), reports=False),
    'no_truth': without_truth(a_loop(3)),
    'two_targets': with_second_target(a_loop(3)),
}


def source(recording=None, **metadata):
    s = source_of('some_bag', recording or a_loop(3))
    return s._replace(metadata={**s.metadata, **metadata})


def planned(s, configuration='', settings=None, target_id=-1):
    (plan,) = plans_of(s, a_loop(3).anchors, 'random_q', configuration, settings, target_id)
    return plan


def graph(s, plan=None, settings=None, one_process_each=False, **options):
    how = How(replay=True, settings=settings or {}, one_process_each=one_process_each)
    return complete(s, [plan or planned(s)], FEED, how, **options)


def by_name(processes):
    return {p.name: p for p in processes}


def refusal(*args, **kwargs):
    with pytest.raises(TrackingError) as error:
        planned(*args, **kwargs)
    return str(error.value)


# ---- the plan


def test_three_estimators_and_one_sensing_stage_by_default():
    plan = planned(source())
    assert tuple(plan.outputs) == ('local_1', 'local_2', 'local_3', 'fused_1', 'fused_2', 'fused_3')
    assert [values['id'] for values in plan.estimators] == [1, 2, 3]
    assert {values['input'] for values in plan.estimators} == {'range'}
    assert plan.sensing['trigger.kind'] == 'event'


def test_the_feed_is_overridden_by_the_file_and_the_file_by_the_settings(tmp_path):
    path = tmp_path / 'mine.yaml'
    path.write_text(
        '/**:\n  ros__parameters: {area: [0, 0, 9, 9], fusion_timeout: 0.7, noise.q_max: 9.0}\n'
        '/**/estimator_2:\n  ros__parameters: {noise.q_max: 10.0, noise.q_min: 5.0}\n'
    )
    s = source(area='0 0 3.6 2.4', target_height='1.5', period='2.0')

    def of(number, settings=None):
        values = planned(s, str(path), settings).estimators[number - 1]
        names = ('area', 'target_height', 'fusion_timeout', 'noise.q_max', 'noise.q_min')
        return tuple(values.get(name) for name in names)

    assert of(1) == ([0, 0, 9, 9], 1.5, 0.7, 9.0, None)
    assert of(2) == ([0, 0, 9, 9], 1.5, 0.7, 10.0, 5.0)
    assert of(2, {'noise.q_max': 11.0, 'area': []}) == ([], 1.5, 0.7, 11.0, 5.0)
    plain = planned(s, 'random_q').estimators[0]
    assert plain['area'] == [0.0, 0.0, 3.6, 2.4]
    assert plain['fusion_timeout'] == pytest.approx(0.4)  # 0.2 T


def test_the_configuration_is_the_one_asked_for_else_the_feeds_else_random_q():
    assert 'nodes' in planned(source(configuration='random_q'), 'danis_three').estimators[0]
    assert 'nodes' in planned(source(configuration='danis_three')).estimators[0]
    nameless = source()._replace(metadata={})
    assert planned(nameless).estimators[0]['update.kind'] == planned(nameless, 'random_q').estimators[0]['update.kind']
    assert planned(source(configuration='random_q')).estimators == planned(source(), 'random_q').estimators
    assert planned(nameless, load_configuration('danis_three')).sensing is None


def test_danis_three_gives_every_estimator_its_own_receivers():
    plan = planned(source(), 'danis_three')
    assert [set(values['nodes']) for values in plan.estimators] == [
        {10, 21, 32, 42}, {20, 31, 41, 11}, {30, 40, 12, 22}
    ]  # fmt: skip
    assert plan.sensing is None
    assert {values['input'] for values in plan.estimators} == {'rssi'}
    started = by_name(graph(source(), plan))
    assert [declared(started[f'estimator_{i}'])['nodes'] for i in (1, 2, 3)] == [v['nodes'] for v in plan.estimators]


@pytest.mark.parametrize(('peers', 'outputs'), [([2], 'local_2 fused_2'), ([7, 4], 'local_4 local_7 fused_4 fused_7')])
def test_peers_are_all_estimators_that_there_are(peers, outputs):
    plan = planned(source(), settings={'peers': peers})
    assert tuple(plan.outputs) == tuple(outputs.split())
    for values in plan.estimators:
        assert values['peers'] == sorted(peers)
        assert set(build(EXECUTABLES['estimator_node'], values).all_peers) == set(peers)


@pytest.mark.parametrize(
    ('settings', 'words'),
    [
        ({'peers': []}, '`peers` is empty'),
        ({'peers': [1, 1]}, 'names an estimator twice'),
        ({'noise.q_max': 1.0}, '`noise.q_max` 1 is below `noise.q_min`'),
        ({'noise.q_max': 'a'}, "parameter `noise.q_max` is 'a': expected a number"),
        ({'trigger.e_max': 0.1}, '`trigger.e_max` 0.1 dB is not above'),
        ({'trigger.kind': 'never'}, "parameter `trigger.kind` is 'never': expected one of event"),
        ({'area': [1, 2]}, '`area` is [1.0, 2.0]: expected x_min'),
        ({'fusion.rule': 'mean', 'fusion.feedback': True}, '`fusion.feedback` needs a fused covariance'),
        ({'target_id': 9}, 'some_bag has no target 9: expected one of [1]'),
    ],
)
def test_wrong_parameters_are_refused_before_anything_starts(settings, words):
    assert words in refusal(source(), settings=settings)


@pytest.mark.parametrize(
    ('metadata', 'words'),
    [
        ({'area': '0 0 x 1'}, 'some_bag: its metadata'),
        ({'area': '0 0 1'}, '`area` is [0.0, 0.0, 1.0]'),
        ({'area': '0 0 nan 1'}, 'parameter `area` is'),
        ({'target_height': 'tall'}, 'holds no number'),
        ({'period': '-1'}, 'parameter `fusion_timeout`'),
    ],
)
def test_wrong_metadata_are_refused(metadata, words):
    assert words in refusal(source(**metadata))


def test_what_the_system_cannot_take_is_refused():
    seen = source()._replace(entry_level='observation')
    assert {values['input'] for values in planned(seen).estimators} == {'observation'}
    assert 'the bag enters at level observation' in refusal(seen, settings={'input': 'range'})
    assert 'the bag enters at level rssi' in refusal(source(), settings={'input': 'observation'})
    assert '`input` is rssi, but the bag enters at level range' in refusal(
        source(BAGS['range']), settings={'input': 'rssi'}
    )


def test_ranges_bypass_the_sensing_nodes():
    plan = planned(source(BAGS['range']))
    assert plan.sensing is None
    assert not [p for p in graph(source(BAGS['range']), plan) if p.executable == 'sensing_node']


def test_signal_strengths_may_go_into_the_filters_as_such():
    plan = planned(source(), settings={'input': 'rssi'})
    assert plan.sensing is None
    assert by_name(graph(source(), plan))['estimator_1'].takes[3] == 'rssi'


def test_some_estimators_may_take_ranges_and_others_signal_strengths(tmp_path):
    path = tmp_path / 'mixed.yaml'
    path.write_text('/**/estimator_2:\n  ros__parameters: {input: rssi}\n')
    plan = planned(source(), str(path))
    assert [values['input'] for values in plan.estimators] == ['range', 'rssi', 'range']
    assert plan.sensing is not None


# ---- the target


def test_every_process_is_told_the_same_target():
    """What a node hears first depends on the order of arrival."""
    s = source(BAGS['two_targets'])
    assert s.targets == (1, 4)
    for target_id, wanted in ((-1, 1), (4, 4)):
        plan = planned(s, target_id=target_id)
        assert plan.target_id == wanted
        told = graph(s, plan, evaluator={}, one_process_each=True)
        tracking = [p for p in told if p.executable in {'sensing_node', 'estimator_node'}]
        assert {declared(p)['target_id'] for p in tracking} == {wanted}
        assert declared(by_name(told)['evaluator'])['targets'] == [wanted]
    assert planned(s, settings={'target_id': 4}).target_id == 4
    assert planned(s, settings={'target_id': 4}, target_id=1).target_id == 1
    assert 'has no target 2: expected one of [1, 4]' in refusal(s, target_id=2)


def test_targets_are_in_the_order_of_their_first_message():
    reverse = with_second_target(a_loop(3), 0)
    shifted = reverse._replace(messages=reverse.messages[14:])  # target 0 is heard first
    assert source(shifted).targets == (0, 1)


def test_a_feed_that_is_not_known_yet_leaves_the_target_open():
    unknown = Source('live', 'rssi', (1, 2), (), {}, ('request', 'rssi', 'epoch_end'))
    assert planned(unknown).target_id == -1
    assert planned(unknown, target_id=6).target_id == 6


# ---- the graph


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


# ---- whole graphs


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


def test_a_section_of_no_node_is_refused_with_the_nearest_name(tmp_path):
    path = tmp_path / 'misspelt.yaml'
    path.write_text('/**:\n  ros__parameters: {seed: 1}\n/**/estimater_1:\n  ros__parameters: {nodes: [1]}\n')
    source = source_of('a_loop', a_loop(3))
    with pytest.raises(TrackingError, match=r'estimater_1.*estimator_1'):
        planned(source, str(path))


# ---- several systems at once


def test_a_configuration_of_this_package_is_for_its_own_system_alone():
    """What it says means another thing to another system, or nothing; that has its own."""
    s, anchors = source(BAGS['range']), a_loop(3).anchors
    every = {plan.system: plan for plan in plans_of(s, anchors, 'all', 'hybrid_labyrinth')}
    (own,) = plans_of(s, anchors, 'hybrid', 'hybrid_labyrinth')
    assert every['hybrid'] == own
    for system in set(graphs.SYSTEMS) - {'hybrid'}:
        assert every[system] == plans_of(s, anchors, system)[0]
    with pytest.raises(TrackingError, match='configuration `random_q` is of system random_q, not of hybrid, human'):
        plans_of(s, anchors, 'hybrid,human', 'random_q')


def test_a_file_of_the_users_is_for_all_and_who_refuses_it_is_told(tmp_path):
    path = tmp_path / 'mine.yaml'
    path.write_text('/**:\n  ros__parameters: {target_height: 0.5}\n')
    plans = plans_of(source(), a_loop(3).anchors, 'all', str(path))
    assert {plan.parameters['target_height'] for plan in plans} == {0.5}
    own = {'estimator_2': 'noise.q_max: 9.0', 'hybrid_tracker': 'form: imm', 'consensus_node': 'rounds: 2'}
    path.write_text(''.join(f'/**/{node}:\n  ros__parameters: {{{value}}}\n' for node, value in own.items()))
    every = {plan.system: plan for plan in plans_of(source(), a_loop(3).anchors, 'all', str(path))}
    assert every['random_q'].estimators[1]['noise.q_max'] == 9.0
    assert (every['hybrid'].config.form, every['consensus'].values['rounds']) == ('imm', 2)
    path.write_text('/**/hybrid_trakker:\n  ros__parameters: {form: imm}\n')
    with pytest.raises(TrackingError, match=r'hybrid_trakker.*did you mean `hybrid_tracker`'):
        plans_of(source(), a_loop(3).anchors, 'hybrid', str(path))
    path.write_text('/**:\n  ros__parameters: {start.kind: likelihood}\n')
    with pytest.raises(TrackingError, match=r'system hybrid: parameter `start.kind` is .likelihood.: expected one of'):
        plans_of(source(), a_loop(3).anchors, 'random_q,hybrid', str(path))


# ---- live, behind a serial line


def test_nobody_waits_for_a_window_behind_a_serial_line():
    """A sink cannot be told to wait: nobody but peers takes estimates, and nobody is promised more."""
    for process in graphs.serial():
        promised = [entry.partition('=')[0] for entry in process.parameters['expected_subscribers']]
        assert not [topic for topic in promised if topic.startswith('estimate/fused')]
        assert 'estimate/fused_1' not in process.takes


@pytest.mark.parametrize('level', ['rssi', 'range'])
@pytest.mark.parametrize('trackers', ['', 'human', 'hybrid,loss_tolerant', 'consensus', 'all'])
def test_any_system_tracks_behind_a_serial_line(trackers, level):
    """Each by parameters of its own; what has the same name and is of the sink stays the sink's (`profile`)."""
    graph = graphs.serial(trackers=trackers, level=level, settings={'port': 'x', 'period': 4.0})
    by_name = {p.name: p for p in graph}
    bridge = build(EXECUTABLES['serial_bridge_node'], by_name['serial_bridge'].parameters)
    assert (bridge.port, bridge.profile, bridge.period) == ('x', 0xBF01, 4.0)
    assert by_name['serial_bridge'].gives == ('anchors', 'request', level, 'epoch_end')
    assert ('sensing' in by_name) == (level == 'rssi' and trackers in {'', 'all'})
    for process in graph:
        config = build(EXECUTABLES[process.executable], process.parameters)
        if hasattr(config, 'loss_timeout') and not process.name.startswith('consensus'):
            assert config.loss_timeout >= 4.0
        if process.name.endswith('_tracker'):
            assert config.input == level


def test_configuration_of_a_field_is_for_whatever_tracks_there(tmp_path):
    path = tmp_path / 'field.yaml'
    path.write_text(
        '/**:\n  ros__parameters: {particles: 123}\n/**/serial_bridge:\n  ros__parameters:\n'
        '    {anchors: {ids: [4, 7], x: [0.0, 5.0], y: [0.0, 1.0]}}\n'
    )
    by_name = {p.name: p for p in graphs.serial(str(path), trackers='human')}
    assert by_name['human_tracker'].parameters['particles'] == 123
    assert by_name['serial_bridge'].parameters['anchors.ids'] == [4, 7]
    path.write_text('/**:\n  ros__parameters: {particles: 123}\n')
    with pytest.raises(TrackingError, match=r'`anchors.ids` of the bridge is empty'):
        graphs.serial(str(path), trackers='human')
    with pytest.raises(TrackingError, match='level'):
        graphs.serial(level='observation')


def test_no_epoch_is_given_up_before_the_bridge_ends_it():
    slow = {p.name: p for p in graphs.serial(settings={'period': 4.0})}
    assert slow['sensing'].parameters['loss_timeout'] == slow['estimator_2'].parameters['loss_timeout'] == 4.0
    quick = {p.name: p for p in graphs.serial(settings={'period': 0.1})}
    assert quick['sensing'].parameters['loss_timeout'] == 1.0
    with pytest.raises(TrackingError, match='ends an epoch after 2 s, but `loss_timeout` of sensing is 1 s'):
        graphs.serial(settings={'period': 0.1, 'epoch_timeout': 2.0})


# ---- two robots in phase


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

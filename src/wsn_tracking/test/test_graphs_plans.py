"""The plan of a graph: parameters by precedence, one target for all, refused before anything starts."""

from __future__ import annotations

import pytest
from graph_cases import a_loop, with_second_target
from plan_cases import BAGS, by_name, graph, planned, refusal, source

from wsn_tracking.configuration import load_configuration
from wsn_tracking.errors import TrackingError
from wsn_tracking.graphs import Source, source_of
from wsn_tracking.node_parameters.executables import EXECUTABLES
from wsn_tracking.parameters import build
from wsn_tracking.processes import declared


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


def test_a_section_of_no_node_is_refused_with_the_nearest_name(tmp_path):
    path = tmp_path / 'misspelt.yaml'
    path.write_text('/**:\n  ros__parameters: {seed: 1}\n/**/estimater_1:\n  ros__parameters: {nodes: [1]}\n')
    source = source_of('a_loop', a_loop(3))
    with pytest.raises(TrackingError, match=r'estimater_1.*estimator_1'):
        planned(source, str(path))


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

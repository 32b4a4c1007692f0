"""Several systems in one graph, each by its own configuration."""

from __future__ import annotations

import pytest
from graph_cases import a_loop
from plan_cases import BAGS, source

from wsn_tracking import graphs
from wsn_tracking.errors import TrackingError
from wsn_tracking.graphs import plans_of


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

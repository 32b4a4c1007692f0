"""Graphs behind a serial line: any system tracks there, nobody waits in vain or gives up too early."""

from __future__ import annotations

import pytest
from plan_cases import by_name

from wsn_tracking import graphs
from wsn_tracking.errors import TrackingError
from wsn_tracking.node_parameters.executables import EXECUTABLES
from wsn_tracking.parameters import build


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
    processes = by_name(graphs.serial(trackers=trackers, level=level, settings={'port': 'x', 'period': 4.0}))
    bridge = build(EXECUTABLES['serial_bridge_node'], processes['serial_bridge'].parameters)
    assert (bridge.port, bridge.profile, bridge.period) == ('x', 0xBF01, 4.0)
    assert processes['serial_bridge'].gives == ('anchors', 'request', level, 'epoch_end')
    assert ('sensing' in processes) == (level == 'rssi' and trackers in {'', 'all'})
    for process in processes.values():
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
    processes = by_name(graphs.serial(str(path), trackers='human'))
    assert processes['human_tracker'].parameters['particles'] == 123
    assert processes['serial_bridge'].parameters['anchors.ids'] == [4, 7]
    path.write_text('/**:\n  ros__parameters: {particles: 123}\n')
    with pytest.raises(TrackingError, match=r'`anchors.ids` of the bridge is empty'):
        graphs.serial(str(path), trackers='human')
    with pytest.raises(TrackingError, match='level'):
        graphs.serial(level='observation')


def test_no_epoch_is_given_up_before_the_bridge_ends_it():
    slow = by_name(graphs.serial(settings={'period': 4.0}))
    assert slow['sensing'].parameters['loss_timeout'] == slow['estimator_2'].parameters['loss_timeout'] == 4.0
    quick = by_name(graphs.serial(settings={'period': 0.1}))
    assert quick['sensing'].parameters['loss_timeout'] == 1.0
    with pytest.raises(TrackingError, match='ends an epoch after 2 s, but `loss_timeout` of sensing is 1 s'):
        graphs.serial(settings={'period': 0.1, 'epoch_timeout': 2.0})

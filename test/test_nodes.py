"""Nodes as processes: they end cleanly, refuse bad parameters in one line, and survive each other's death."""

from __future__ import annotations

import json
import signal
import subprocess

import pytest
import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.duration import Duration
from std_msgs.msg import String
from wsn_tracking_msgs import msg

import live
from observer import observing
from wsn_tracking import graphs
from wsn_tracking.graphs import Process
from wsn_tracking.node_parameters.executables import EXECUTABLES
from wsn_tracking.nodes import qos
from wsn_tracking.processes import ended, executable

TIMEOUT = 120.0  # [s] far beyond what a start takes on a busy machine
STANDALONE = sorted(set(EXECUTABLES) - {'bag_player_node'})  # the player needs a bag


def ran(name, *arguments, environment):
    """A process that is expected to end by itself."""
    return subprocess.run(
        [str(executable(name)), *arguments],
        env=environment,
        capture_output=True,
        text=True,
        timeout=TIMEOUT,
        check=False,
    )


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize('name', STANDALONE)
def test_node_starts_on_defaults_and_ends_with_0_when_asked(name, number, tmp_path):
    with live.private_domain() as environment:
        process = subprocess.Popen(
            [str(executable(name))],
            env=environment,
            cwd=tmp_path,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        try:
            with observing(environment) as observer:
                observer.until_node(name, TIMEOUT)
            process.send_signal(number)
            output, _ = process.communicate(timeout=TIMEOUT)
        finally:
            process.kill()
    assert process.returncode == 0, output
    assert 'Traceback' not in output


@pytest.mark.parametrize('name', ['consensus_node', 'estimator_node'])
def test_a_node_on_its_own_says_what_it_waits_for(name, tmp_path):
    with live.private_domain() as environment:
        process = live.start(Process(name, 'alone', {'silence_timeout': 0.01}), environment, tmp_path)
        try:
            assert 'waits for anchors' in process.stdout.readline()
            process.send_signal(signal.SIGINT)
            output, _ = process.communicate(timeout=TIMEOUT)
        finally:
            process.kill()
    assert 'waits for' not in output  # once is enough


@pytest.mark.parametrize(
    ('name', 'setting', 'words'),
    [
        ('sensing_node', 'trigger.kind:=sometimes', ['trigger.kind', 'sometimes', 'event, near']),
        ('sensing_node', 'trigger.alpha:=1.5', ['trigger.alpha', '1.5', '<= 1']),
        ('estimator_node', 'noise.q_max:=hello', ['noise.q_max', 'hello', 'a number']),
        ('estimator_node', 'noise.q_min:=9.0', ['noise.q_max', 'below']),
        ('estimator_node', 'area:=[1.0, 1.0, 0.0, 2.0]', ['area', 'min < max']),
        ('hybrid_tracker_node', 'form:=magic', ['form', 'magic', 'inflate, decay']),
        ('hybrid_tracker_node', 'channel:=no/such.yaml', ['no/such.yaml', 'expected a file of']),
        ('loss_tolerant_tracker_node', 'filter:=magic', ['filter', 'magic', 'ckf, ekf']),
        ('world_node', 'scenario:=nowhere', ['nowhere', 'a_loop']),
        ('world_node', "settings:=['nodes=20']", ['`a_loop` has no parameter `nodes`']),
        ('world_node', "settings:=['faults']", ["'faults'", 'expected name=value']),
        ('bag_player_node', 'bag:=no/such/bag', ['no/such/bag']),
        ('bag_player_node', 'rate:=-1.0', ['rate', '-1.0', '>= 0']),
        ('evaluator_node', 'expected_subscribers:=[range]', ['expected_subscribers', 'topic=count']),
    ],
)
def test_bad_parameter_is_refused_in_one_line(name, setting, words):
    with live.private_domain() as environment:
        done = ran(name, '--ros-args', '-p', setting, environment=environment)
    assert done.returncode == 2
    lines = done.stderr.strip().splitlines()
    assert len(lines) == 1, done.stderr
    assert lines[0].startswith('error: ')
    for word in words:
        assert word in lines[0]


@pytest.mark.parametrize(
    ('name', 'arguments', 'words'),
    [
        ('estimator_node', ['--params-file', 'none.yaml'], ['none.yaml', 'Error opening YAML file']),
        ('estimator_node', ['--bogus'], ['--bogus', '-p NAME:=VALUE']),
        ('sensing_node', ['-p', 'use_sim_time:=3'], ['use_sim_time', "'BOOL'"]),
        ('evaluator_node', ['-p', 'outputs:=[bad name]'], ['topic name', 'bad name']),
    ],
)
def test_what_ros_refuses_is_told_in_one_line(name, arguments, words):
    """rcl itself may have said something before."""
    with live.private_domain() as environment:
        done = ran(name, '--ros-args', *arguments, environment=environment)
    assert done.returncode == 2
    last = done.stderr.strip().splitlines()[-1]
    assert last.startswith('error: ')
    assert 'Traceback' not in done.stderr
    assert '.c:' not in last  # places in the sources of ROS 2
    for word in words:
        assert word in last


def test_a_recorder_that_is_refused_leaves_no_bag_behind(tmp_path):
    with live.private_domain() as environment:
        words = ['-p', f'output:={tmp_path / "new"}', '-p', 'extra_topics:=[what]']
        done = ran('bag_recorder_node', '--ros-args', *words, environment=environment)
    assert (done.returncode, 'topic `what` has no known type' in done.stderr) == (2, True)
    assert not (tmp_path / 'new').exists()


def test_the_others_go_on_when_an_estimator_is_killed(tmp_path):
    """SIGKILL in mid-run: the player says whose output fell silent, the others' fused estimates reach the end."""
    scores = tmp_path / 'scores.json'
    graph = graphs.replay(str(live.A_LOOP), rate=20.0, evaluator={'json': str(scores), 'output_timeout': 1.0})
    graph = tuple(
        p._replace(parameters={**p.parameters, 'output_timeout': 1.0, 'fusion_timeout': 0.2, 'lossless': False})
        for p in graph
    )
    with (
        live.private_domain() as environment,
        observing(environment) as observer,
        live.started(graph, environment) as running,
    ):
        fused = observer.collect(msg.TargetEstimate, 'estimate/fused_2', qos.ESTIMATES)
        observer.until(lambda: any(e.request_seq >= 20 for e in fused), TIMEOUT, 'epoch 20 of fused_2')
        running['estimator_2'].kill()
        player, _ = running['bag_player'].communicate(timeout=TIMEOUT)
        evaluator, _ = running['evaluator'].communicate(timeout=TIMEOUT)
    assert running['bag_player'].returncode == 1
    assert 'estimate/fused_2 has been silent' in player
    assert running['evaluator'].returncode == 1
    assert 'estimate/local_2 did not reach the final epoch' in evaluator
    outputs = json.loads(scores.read_text())['outputs']
    assert outputs['fused_1']['epochs'] == outputs['fused_3']['epochs'] == 115
    assert outputs['local_2']['epochs'] < 115


def test_a_restarted_estimator_takes_part_again(tmp_path):
    """SIGKILL, then started anew in mid-run: the others go on meanwhile, and fuse its estimates again.

    Fusion waits for a second: only who is gone is missing, not who is slow on a busy machine. How soon it takes part is
    for a study to say (docs/system_a.md).
    """
    graph = {p.name: p for p in graphs.replay(str(live.A_LOOP), rate=4.0, settings={'fusion_timeout': 1.0})}
    with (
        live.private_domain() as environment,
        observing(environment) as observer,
        live.started(list(graph.values()), environment) as running,
    ):
        fused = observer.collect(msg.TargetEstimate, 'estimate/fused_1', qos.ESTIMATES)

        def reaches(condition):
            return lambda: any(condition(e) for e in fused)

        observer.until(reaches(lambda e: e.request_seq >= 8), TIMEOUT, 'epoch 8 of fused_1')
        running['estimator_2'].kill()
        observer.until(reaches(lambda e: list(e.contributors) == [1, 3]), TIMEOUT, 'fusion without estimator 2')
        alone = len(fused)
        observer.forget('/estimator_2')
        running['again'] = live.start(graph['estimator_2'], environment, tmp_path)
        # how long an interpreter takes to start is the machine's matter
        observer.until(lambda: observer.told('/estimator_2'), TIMEOUT, 'estimator 2 started anew')
        back = reaches(lambda e: e.request_seq > fused[alone - 1].request_seq and 2 in e.contributors)
        observer.until(back, TIMEOUT, 'estimator 2 in fused_1 again')
        joined = fused[-1].request_seq
        observer.until(reaches(lambda e: e.request_seq >= joined + 8), TIMEOUT, 'eight more epochs of fused_1')
    assert [e.request_seq for e in fused] == list(range(fused[0].request_seq, fused[-1].request_seq + 1))
    assert all(2 in e.contributors for e in fused if e.request_seq >= joined)


def test_nodes_of_simulated_time_wait_for_no_clock():
    """/clock is told by the feed, which begins when all are ready: whoever waited for it would wait for ever."""
    simulated = {'use_sim_time': True}
    graph = [
        Process('sensing_node', 'sensing', simulated),
        Process(
            'world_node', 'world', {**simulated, 'rate': 0.0, 'expected_nodes': ['sensing'], 'ready_timeout': TIMEOUT}
        ),
    ]
    with live.private_domain() as environment, live.started(graph, environment) as running:
        assert 'sent 120 epochs' in live.wait_all(running, ['world'], 2.0 * TIMEOUT)['world']


def test_the_evaluator_counts_what_its_own_graph_has_dropped(tmp_path):
    """On /diagnostics every graph of the domain is heard, and drivers whose counters are no numbers."""
    scores = tmp_path / 'scores.json'
    told = {'/robot1/sensing': '3', '/robot2/sensing': '50', '/sensing': '700', '/robot1/camera': 'a few'}
    statuses = [
        DiagnosticStatus(name=name, values=[KeyValue(key='dropped.late', value=count)]) for name, count in told.items()
    ]
    words = ['-r', '__ns:=/robot1', '-p', 'outputs:=[none]', '-p', 'output_timeout:=0.1', '-p', f'json:={scores}']
    with live.private_domain() as environment, observing(environment) as observer:
        diagnostics = observer.node.create_publisher(DiagnosticArray, '/diagnostics', qos.ESTIMATES)
        ends = observer.node.create_publisher(msg.EpochEnd, '/robot1/epoch_end', qos.MEASUREMENTS)
        with ended([str(executable('evaluator_node')), '--ros-args', *words], env=environment) as evaluator:
            observer.until(lambda: diagnostics.get_subscription_count() == 2, TIMEOUT, 'both listen to diagnostics')
            observer.until(lambda: ends.get_subscription_count() == 1, TIMEOUT, 'the evaluator listens')
            diagnostics.publish(DiagnosticArray(status=statuses))
            assert diagnostics.wait_for_all_acked(Duration(seconds=TIMEOUT))
            ends.publish(msg.EpochEnd(target_id=1, final=True))
            evaluator.wait(TIMEOUT)
    assert json.loads(scores.read_text())['input'] == {'late': 3}


def test_a_feed_outlives_the_recorder_of_its_own_graph_only():
    """Another graph of the domain may record for long."""
    words = ['-r', '__ns:=/a', '-p', 'expected_nodes:=[bag_recorder]', '-p', 'rate:=0.0', '-p', 'output_timeout:=600.0']
    with live.private_domain() as environment, observing(environment) as observer:
        other = rclpy.create_node('bag_recorder', namespace='/b', context=observer.node.context)
        other.create_publisher(String, '/a/ready', qos.LATCHED).publish(String(data='bag_recorder'))
        with ended([str(executable('world_node')), '--ros-args', *words], env=environment) as world:
            assert world.wait(2.0 * TIMEOUT) == 0
        other.destroy_node()


def test_a_feed_ends_where_another_graph_tells_its_epochs_too():
    """Estimators that an earlier run left behind, or a run of somebody else: the results of both would be mixed."""
    words = ['-p', 'window_topics:=[estimate/fused_1]', '-p', 'rate:=0.0', '-p', f'output_timeout:={TIMEOUT}']
    estimate = msg.TargetEstimate(
        target_id=1, source='fused_1', state_names=['x', 'y'], mean=[0.0] * 2, covariance=[1.0, 0.0, 0.0, 1.0]
    )
    with live.private_domain() as environment, observing(environment) as observer:
        told = observer.node.create_publisher(msg.TargetEstimate, 'estimate/fused_1', qos.ESTIMATES)
        command = [str(executable('world_node')), '--ros-args', *words]
        with ended(command, env=environment, stderr=subprocess.STDOUT) as world:

            def has_ended():
                told.publish(estimate)
                return world.poll() is not None

            observer.until(has_ended, TIMEOUT, 'end of the feed')
            assert world.returncode == 1
            assert 'estimate/fused_1 told epoch 0 of target 1' in world.stdout.read()


def test_a_second_feed_does_not_begin_while_another_is_there():
    words = ['--ros-args', '-p', 'expected_nodes:=[somebody]', '-p', 'rate:=0.0', '-p', f'ready_timeout:={TIMEOUT}']
    with live.private_domain() as environment, observing(environment) as observer:
        observer.node.create_publisher(msg.LocationRequest, 'request', qos.FED)
        observer.node.create_publisher(String, 'ready', qos.LATCHED).publish(String(data='somebody'))
        command = [str(executable('world_node')), *words]
        with ended(command, env=environment, stderr=subprocess.STDOUT) as world:
            told = next(line for line in world.stdout if 'begun' in line)
    assert 'another node publishes /request: not begun before it has gone' in told

"""The trackers that are one node, as running processes: equal to the evaluation, alone and alongside all others."""

from __future__ import annotations

import json

import pytest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseArray
from wsn_tracking_msgs import msg

import live
from feeding import Feed, first_epochs
from observer import observing
from wsn_tracking import graphs
from wsn_tracking.bags.estimates import differences, read_estimates
from wsn_tracking.bags.save import save
from wsn_tracking.evaluation.report_json import to_json
from wsn_tracking.evaluation.run import summarise
from wsn_tracking.nodes import convert, convert_human, qos
from wsn_tracking.offline import offline
from wsn_tracking.sensing.recording import epoch_key, of_target
from wsn_tracking.sensing.values import EpochEnd, Range
from wsn_tracking.simulation.record import record
from wsn_tracking.simulation.scenarios import scenario
from wsn_tracking.studies.live import targets


def recorded(name, epochs, seed=1):
    """The first epochs of a scenario, of every target."""
    return first_epochs(record(scenario(name, seed=seed), seed), epochs)


def seq_of(message):
    return epoch_key(message)[1]


@pytest.mark.parametrize(
    ('name', 'epochs', 'trackers', 'outputs'),
    [
        ('c_circle', 30, '', ['human', 'human_lag']),
        ('d_phase', 60, '', ['hybrid_target_1', 'hybrid_target_2']),
        ('e_loss', 30, '', ['loss_tolerant']),
        ('d_phase', 20, 'all', ['local_1', 'consensus_7', 'human', 'hybrid_target_2', 'loss_tolerant']),
        ('b_field', 4, 'human,hybrid,loss_tolerant,random_q', ['fused_2', 'human', 'hybrid_target_1']),
    ],
)
def test_graph_equals_evaluation(tmp_path, name, epochs, trackers, outputs):
    """Every decoded number of every estimate, and every figure of the table."""
    bag, scores = tmp_path / name, tmp_path / 'scores.json'
    save(bag, recorded(name, epochs))
    source, recording = graphs.open_bag(str(bag))
    run = offline(source, recording, trackers=trackers)
    recorder = {'output': str(tmp_path / 'out'), 'derived': True}
    graph = graphs.replay(
        str(bag),
        rate=0.0,
        trackers=trackers,
        record=recorder,
        evaluator={'json': str(scores), 'skip': 0.5},
        settings=live.PATIENT,
    )
    with live.private_domain() as environment, live.started(graph, environment) as running:
        live.wait_all(running, ['bag_player', 'evaluator', 'bag_recorder'], live.TIMEOUT)
    published = read_estimates(tmp_path / 'out')
    assert set(outputs) <= set(published)
    assert set(published) == set(run.estimates) - {'mean', 'lci'}
    for output, estimates in published.items():
        assert differences(estimates, run.estimates[output]) == []
    told = json.loads(scores.read_text())
    assert told == json.loads(json.dumps(to_json(summarise(name, recording, run, 0.5))))


def test_targets_come_go_and_are_confused_without_disturbing_another_track():
    """Target 1 is there throughout; 2 vanishes, 3 appears, 7 is only named, and 1's ranges come under 2's id."""
    whole = recorded('d_phase', 60)
    one, other = (of_target(whole, target).messages for target in (1, 2))
    vanishing = [m for m in other if seq_of(m) < 20]
    appearing = [m._replace(target_id=3) for m in other if seq_of(m) >= 30]
    nobody = [m._replace(target_id=7) for m in one if isinstance(m, Range) and seq_of(m) % 10 == 5]
    confused = [
        m._replace(target_id=2, node_id=m.node_id, seq=m.seq + 5000, range=m.range + 1.5)
        for m in one
        if isinstance(m, Range) and 10 <= seq_of(m) < 20
    ]
    messages = sorted([*one, *vanishing, *appearing, *nobody, *confused], key=lambda m: (m.stamp_ns, seq_of(m)))
    (plan,) = graphs.plans_of(graphs.source_of('whole', whole), whole.anchors, 'hybrid')
    values = {**plan.values, 'targets': [], 'loss_timeout': 0.2}
    graph = [graphs.Process('hybrid_tracker_node', 'hybrid_tracker', values)]
    with (
        live.private_domain() as environment,
        observing(environment) as observer,
        live.started(graph, environment) as running,
    ):
        feed = Feed(observer, whole.anchors, Range)
        seen = {
            i: observer.collect(msg.TargetEstimate, f'estimate/hybrid_target_{i}', qos.ESTIMATES) for i in (1, 2, 3)
        }
        told = observer.collect(DiagnosticArray, '/diagnostics', qos.ESTIMATES)
        feed.until_heard(live.TIMEOUT)
        for message in messages:
            feed.send(message)
            if isinstance(message, EpochEnd) and message.target_id == 1:
                seq = message.request_seq
                observer.until(lambda seq=seq: any(e.request_seq == seq for e in seen[1]), live.TIMEOUT, f'epoch {seq}')
        observer.until(lambda: any(e.request_seq == 59 for e in seen[3]), live.TIMEOUT, 'the last epoch of 3')
        told.clear()
        observer.until(lambda: bool(told), live.TIMEOUT, 'diagnostics')
        assert running['hybrid_tracker'].poll() is None
    counters = {pair.key: pair.value for pair in told[-1].status[0].values}
    alone = offline(graphs.source_of('one', of_target(whole, 1)), of_target(whole, 1), trackers='hybrid')
    ours = [convert.estimate_value(e) for e in seen[1]]
    assert differences(ours, alone.estimates['hybrid_target_1']) == []
    assert [e.request_seq for e in seen[2]] == list(range(20))
    assert [e.request_seq for e in seen[3]] == list(range(30, 60))
    assert sum(int(n) for name, n in counters.items() if name.startswith('dropped.')) >= len(confused)


def test_twenty_targets_at_20_hz_lose_nothing(monkeypatch):
    """The study of `make study`, shorter: 6 s. How much of a core the node takes, is for the study to say."""
    with live.private_domain() as environment:
        for name in ('ROS_DOMAIN_ID', 'ROS_AUTOMATIC_DISCOVERY_RANGE'):
            monkeypatch.setenv(name, environment[name])
        told = targets(seconds=6.0)
    assert (told['targets'], told['exit_code'], told['dropped']) == (20, 0, {})
    assert told['worst_rmse_m'] < 0.2


def test_particles_and_what_they_say_are_shown_to_who_looks(tmp_path):
    bag = tmp_path / 'c_circle'
    save(bag, recorded('c_circle', 40))
    settings = {**live.PATIENT, 'particles': 200, 'particle_rate': 100.0}
    graph = graphs.replay(str(bag), rate=2.0, trackers='human', settings=settings)
    with (
        live.private_domain() as environment,
        observing(environment) as observer,
        live.started(graph, environment) as running,
    ):
        clouds = observer.collect(PoseArray, 'particles/human', qos.DISPLAY)
        reports = observer.collect(msg.HumanReport, 'human_report', qos.MEASUREMENTS)
        observer.until(lambda: bool(clouds) and bool(reports), live.TIMEOUT, 'particles and reports')
        assert running['human_tracker'].poll() is None
    assert len(clouds[0].poses) == 200
    assert clouds[0].header.frame_id == 'map'
    assert all(abs(p.position.x) <= 15.0 and abs(p.position.y) <= 15.0 for p in clouds[0].poses)
    report = convert_human.report_value(reports[-1])
    assert report.node_ids == (1, 2, 3, 4)
    assert len(report.node_log_evidences) == 4
    assert 1.0 <= report.n_eff <= report.particles == 200
    assert 0.0 <= report.heading_known <= 1.0
    assert not report.reset
    assert convert_human.report_message(report) == reports[-1]

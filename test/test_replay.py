"""A recorded bag through the live graph gives what the evaluator computes, to the last bit."""

from __future__ import annotations

import json
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import live
from feeding import first_epochs
from wsn_tracking import graphs
from wsn_tracking.bags.estimates import differences, read_estimates
from wsn_tracking.bags.save import save
from wsn_tracking.evaluation.run import summarise
from wsn_tracking.offline import offline
from wsn_tracking.sensing.recording import epoch_key

REPEATS = 3
CASES = ((1.0, 5), (20.0, 40), (0.0, 120))  # rate (0: as fast as it goes), epochs


@pytest.fixture(scope='module')
def bags(tmp_path_factory):
    """The first epochs of bags/a_loop by their number."""
    _, recording = graphs.open_bag(str(live.A_LOOP))
    folder = tmp_path_factory.mktemp('bags')
    paths = {}
    for epochs in {epochs for _, epochs in CASES}:
        paths[epochs] = folder / f'a_loop_{epochs}'
        save(paths[epochs], first_epochs(recording, epochs))
    return paths


def replayed(bag, rate, folder, *, one_process_each=False):
    """Estimates that the live graph published."""
    source, recording = graphs.open_bag(str(bag))
    outputs = graphs.plans_of(source, recording.anchors)[0].outputs
    record = {'output': str(folder), 'extra_topics': [f'estimate/{output}' for output in outputs]}
    graph = graphs.replay(str(bag), rate=rate, record=record, one_process_each=one_process_each, settings=live.PATIENT)
    with live.private_domain() as environment, live.started(graph, environment) as running:
        live.wait_all(running, ['bag_player', 'evaluator', 'bag_recorder'], live.TIMEOUT)
    return read_estimates(folder)


@pytest.mark.parametrize('repeat', range(REPEATS))
def test_graph_equals_evaluation_at_every_rate(bags, tmp_path, repeat):
    """Every decoded number of every estimate, at rate 1, 20 and max, whatever the order of arrival."""

    def case(number):
        rate, epochs = CASES[number]
        return replayed(bags[epochs], rate, tmp_path / f'case_{number}')

    with ThreadPoolExecutor(len(CASES)) as pool:
        published = list(pool.map(case, range(len(CASES))))
    for (_, epochs), estimates in zip(CASES, published, strict=True):
        assert_equal_to_evaluation(bags[epochs], estimates)


def test_a_process_for_every_sensing_node_changes_nothing(bags, tmp_path):
    """Twelve reports an epoch from twelve publishers give the same epochs."""
    estimates = replayed(bags[5], 0.0, tmp_path / 'each', one_process_each=True)
    assert_equal_to_evaluation(bags[5], estimates)


def assert_equal_to_evaluation(bag, estimates):
    """The graph's outputs are those that the evaluator computes from the bag."""
    run = offline(*graphs.open_bag(str(bag)))
    assert set(estimates) == {name for name in run.estimates if name.partition('_')[0] in {'local', 'fused'}}
    for name, published in estimates.items():
        assert len(published) == run.epochs
        assert differences(published, run.estimates[name]) == []


def test_one_target_of_several_is_replayed_alone(tmp_path):
    """A second target that starts late, with dense truth: nothing of it is lost."""
    _, one = graphs.open_bag(str(live.A_LOOP))
    two = first_epochs(one, 12)
    late = [m._replace(target_id=2) for m in first_epochs(one, 20).messages if epoch_key(m)[1] >= 8]
    truth = {1: one.truth[1], 2: dense(one.truth[1])._replace(target_id=2)}
    bag = tmp_path / 'two_targets'
    save(bag, two._replace(messages=(*two.messages, *late), truth=truth))
    run = offline(*graphs.open_bag(str(bag)), target_id=2)
    assert run.epochs == 12
    record = {'output': str(tmp_path / 'out'), 'extra_topics': ['estimate/fused_1']}
    scores = tmp_path / 'scores.json'
    evaluator = {'json': str(scores), 'skip': 0.0}
    graph = graphs.replay(str(bag), rate=0.0, target_id=2, record=record, evaluator=evaluator, settings=live.PATIENT)
    with live.private_domain() as environment, live.started(graph, environment) as running:
        live.wait_all(running, ['bag_player', 'evaluator', 'bag_recorder'], live.TIMEOUT)
    published = read_estimates(tmp_path / 'out')['fused_1']
    assert differences(published, run.estimates['fused_1']) == []
    offline_score = summarise('two_targets', graphs.open_bag(str(bag))[1], run, 0.0).outputs['fused_1']
    assert json.loads(scores.read_text())['outputs']['fused_1']['rmse_m'] == offline_score.rmse_m


def dense(truth):
    """The same walk, sampled a hundred times as often."""
    stamps = np.arange(truth.stamps_ns[0], truth.stamps_ns[-1] + 1, 10_000_000)
    positions = np.column_stack([np.interp(stamps, truth.stamps_ns, axis) for axis in truth.positions.T])
    return truth._replace(stamps_ns=stamps, positions=positions, velocities=np.full_like(positions, np.nan))

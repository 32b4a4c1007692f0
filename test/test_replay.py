"""A recorded bag through the live graph gives what the evaluator computes, to the last bit."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import pytest

import live
from wsn_tracking import graphs
from wsn_tracking.bags.save import save
from wsn_tracking.offline import offline
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.sensing.values import EpochEnd, Request

TIMEOUT = 60.0  # [s]
REPEATS = 3
CASES = ((1.0, 5), (20.0, 40), (0.0, 120))  # rate (0: as fast as it goes), epochs


def shortened(recording: Recording, epochs: int) -> Recording:
    """The first epochs of a recording, the last of them final."""
    kept = [m for m in recording.messages if (m.seq if isinstance(m, Request) else m.request_seq) < epochs]
    last = max(i for i, m in enumerate(kept) if isinstance(m, EpochEnd))
    kept[last] = kept[last]._replace(final=True)
    return recording._replace(messages=tuple(kept))


@pytest.fixture(scope='module')
def bags(tmp_path_factory):
    """The first epochs of bags/a_loop by their number."""
    _, recording = graphs.open_bag(str(live.A_LOOP))
    folder = tmp_path_factory.mktemp('bags')
    paths = {}
    for epochs in {epochs for _, epochs in CASES}:
        paths[epochs] = folder / f'a_loop_{epochs}'
        save(paths[epochs], shortened(recording, epochs))
    return paths


def replayed(bag, rate, folder, *, one_process_each=False):
    """Estimates that the live graph published."""
    outputs = graphs.plan_random_q(graphs.open_bag(str(bag))[0]).outputs
    record = {'output': str(folder), 'extra_topics': [f'estimate/{output}' for output in outputs]}
    graph = graphs.replay(str(bag), rate=rate, record=record, one_process_each=one_process_each)
    with live.private_domain() as environment, live.started(graph, environment) as running:
        live.wait_all(running, ['bag_player', 'evaluator', 'bag_recorder'], TIMEOUT)
    return live.recorded_estimates(folder)


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
        assert live.differences(published, run.estimates[name]) == []

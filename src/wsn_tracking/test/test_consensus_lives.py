"""Nodes of system B die, come back, part and meet again."""

import numpy as np
from consensus_cases import network_of
from consensus_field import FAULTS, IDS, POSITIONS, SMALL, epochs

from wsn_tracking.evaluation.run_consensus import run_consensus
from wsn_tracking.simulation.b_field import b_field
from wsn_tracking.simulation.record import record
from wsn_tracking.trackers.consensus_config import ConsensusConfig
from wsn_tracking.trackers.consensus_network import run_epoch

SAME_PLACE = 0.01  # [m] a tenth of what a range errs by


def test_a_neighbour_silent_for_three_epochs_no_longer_counts_and_may_come_back():
    """Node 2 is killed after epoch 2 and started anew, with nothing but the prior, in epoch 8."""
    config = ConsensusConfig(rounds=14)
    nodes = network_of(config, POSITIONS)
    witness = nodes[2].neighbours[0]
    counted, alive = [], []
    for k in range(12):
        if k == 8:
            nodes[2] = network_of(config, POSITIONS)[2]
        estimates = run_epoch(nodes, epochs(k, [i for i in IDS if i != 2 or k < 3 or k >= 8]))
        counted.append(2 in nodes[witness].inbox.active)
        alive.append(2 in estimates[witness].contributors)
    assert counted == [True] * 6 + [False] * 3 + [True] * 3
    assert alive == [True] * 3 + [False] * 6 + [True] * 3


def test_a_restarted_node_is_back_within_three_epochs():
    nodes, reference = (
        network_of(ConsensusConfig(rounds=14), POSITIONS),
        network_of(ConsensusConfig(rounds=14), POSITIONS),
    )
    for k in range(12):
        if k == 8:
            nodes[5] = network_of(ConsensusConfig(rounds=14), POSITIONS)[5]
        ours = run_epoch(nodes, epochs(k, [i for i in IDS if i != 5 or k not in (6, 7)]))
        whole = run_epoch(reference, epochs(k))
    assert np.hypot(*(ours[5].mean - whole[5].mean)[:2]) < SAME_PLACE
    assert ours[5].contributors == tuple(IDS)


def test_halves_that_part_count_themselves_and_meet_again():
    config = ConsensusConfig(rounds=14, link=FAULTS['cut'])
    nodes = network_of(config, POSITIONS)
    left = {i for i in IDS if POSITIONS[i - 1, 0] < 95.0}
    for k in range(12):
        estimates = run_epoch(nodes, epochs(k))
        for i, estimate in estimates.items():
            side = left if i in left else set(IDS) - left
            assert set(estimate.contributors) <= (side if 3 <= k < 8 else set(IDS))
    assert all(e.contributors == tuple(IDS) for e in estimates.values())
    means = np.array([e.mean for e in estimates.values()])
    assert np.ptp(means[:, :2], axis=0).max() < SAME_PLACE
    assert sum(node.counters['cut_share'] for node in nodes.values()) > 0


def test_a_reset_node_is_a_new_one():
    nodes, anew = network_of(ConsensusConfig(rounds=4), POSITIONS), network_of(ConsensusConfig(rounds=4), POSITIONS)
    for k in range(3):
        run_epoch(nodes, epochs(k))
    for node in nodes.values():
        node.reset()
    first, second = run_epoch(nodes, epochs(0)), run_epoch(anew, epochs(0))
    assert all(np.array_equal(first[i].mean, second[i].mean) for i in IDS)


def test_a_recording_is_tracked_without_middleware():
    recording = record(b_field(SMALL), 3)
    config = ConsensusConfig(scheme='flood', rounds=6)
    run = run_consensus(recording, config)
    assert (run.epochs, sorted(run.estimates)) == (12, sorted(f'consensus_{i}' for i in IDS))
    assert run.dropped == {}
    last = run.estimates['consensus_4'][-1]
    miss = last.mean[:2] - recording.truth[1].positions[-1, :2]
    assert miss @ np.linalg.solve(last.covariance[:2, :2], miss) < 13.8  # chi-square of two degrees, one in a thousand
    again = run_consensus(recording, config)
    assert all(
        np.array_equal(a.mean, b.mean)
        for a, b in zip(run.estimates['consensus_4'], again.estimates['consensus_4'], strict=True)
    )
    dying = run_consensus(recording, config, dead={4: 5})
    assert [len(dying.estimates[f'consensus_{i}']) for i in (3, 4)] == [12, 5]
    assert dying.dropped['missing_share'] > 0


def test_a_looped_recording_starts_anew():
    recording = record(b_field(SMALL), 3)
    looped = recording._replace(
        messages=(*recording.messages[:-1], recording.messages[-1]._replace(final=False), *recording.messages)
    )
    run = run_consensus(looped, ConsensusConfig(rounds=3))
    estimates = run.estimates['consensus_1']
    assert run.epochs == 24
    assert np.array_equal(estimates[0].mean, estimates[12].mean)

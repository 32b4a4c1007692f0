"""System B where ranges alone come, in bursts, from a start that nobody knows; and on recorded robots."""

import json
from dataclasses import replace

import numpy as np
import pytest
from consensus_cases import SECOND, R, network_of
from import_cases import real_data

from wsn_tracking.sensing.values import Epoch, Range
from wsn_tracking.studies.real_radio import mrclam
from wsn_tracking.trackers.consensus import Network
from wsn_tracking.trackers.consensus_config import ArrivalConfig, ConsensusConfig, ObservationConfig, PriorConfig
from wsn_tracking.trackers.consensus_network import run_epoch

HALL = np.array(
    [[0.5, -4.0, 0.0], [2.9, -4.2, 0.0], [3.1, -1.0, 0.0], [0.0, 1.5, 0.0], [3.2, 3.9, 0.0], [1.2, 4.5, 0.0]]
)
CONFIG = ConsensusConfig(
    scheme='flood',
    rounds=3,
    radius=5.5,
    spectral_density=0.0014,
    velocity_time=5.0,
    arrival=ArrivalConfig(0.05, 0.9, 0.9, r_max=12.0),
    observation=ObservationConfig(range_std=0.3),
    prior=PriorConfig(mean=(1.6, 0.0, 0.0, 0.0), std=(2.0, 3.0, 0.1, 0.1)),
)


def bursts(seed, epochs=60):
    """A slow walk from anywhere in the hall: two of the nodes range it at a time, and a minute nobody does."""
    rng = np.random.default_rng(seed)
    at = np.array([*rng.uniform([0.3, -4.0], [3.0, 4.2]), 0.0, 0.0])
    stamp = 0
    for k in range(epochs):
        dt = 60.0 if k == 30 else 0.5
        stamp += round(dt * SECOND)
        at[:2] += 0.05 * np.sqrt(dt) * rng.standard_normal(2)
        z = np.hypot(*(HALL[:, :2] - at[:2]).T) + 0.1 * rng.standard_normal(len(HALL))
        yield stamp, at.copy(), np.where(np.isin(np.arange(6), rng.permutation(6)[:2]), z, np.nan)


@pytest.mark.parametrize('scheme', ['flood', 'icf'])
def test_ranges_in_bursts_are_tracked_alike_by_shares_and_batched(scheme):
    config = replace(CONFIG, scheme=scheme)
    network, nodes = Network(config, HALL), network_of(config, HALL)
    state, last = network.start(), None
    for k, (stamp, _, z) in enumerate(bursts(1)):
        dt = 0.0 if last is None else (stamp - last) * 1e-9
        last = stamp
        both = np.column_stack([z, np.full(6, np.nan)])
        state, _ = network.step(state, k, dt, both, R * 9.0, None)
        packets = tuple(Range(stamp, i, 1, k, k, 4, float(r), 0.09) for i, r in enumerate(z, 1) if not np.isnan(r))
        estimates = run_epoch(nodes, dict.fromkeys(nodes, Epoch(1, k, stamp, packets)))
        for i, estimate in estimates.items():
            assert np.abs(estimate.mean - state.belief.m[i - 1]).max() < 1e-9


def test_a_robot_that_may_start_anywhere_is_found_and_found_again():
    """Twelve walks: within ten epochs, and after a minute of silence within ten more."""
    errors = []
    for seed in range(12):
        network, last = Network(CONFIG, HALL), None
        state = network.start()
        for k, (stamp, at, z) in enumerate(bursts(seed)):
            dt = 0.0 if last is None else (stamp - last) * 1e-9
            last = stamp
            state, _ = network.step(state, k, dt, np.column_stack([z, np.full(6, np.nan)]), R * 9.0)
            if k in (10, 29, 40, 59):
                errors.append(np.hypot(*(state.belief.m[:, :2] - at[:2]).T).max())
    assert max(errors) < 0.5


# --- recorded


@pytest.fixture(scope='module')
def opened():
    return mrclam.open_mrclam(real_data('mrclam').parent)


def first_part(recording, target, seconds):
    """What is heard and known of one target until so long after the first message."""
    until = min(m.stamp_ns for m in recording.messages if m.target_id == target) + seconds * SECOND
    truth = recording.truth[target]
    kept = truth.stamps_ns < until
    return recording._replace(
        messages=tuple(m for m in recording.messages if m.target_id == target and m.stamp_ns < until),
        truth={
            target: truth._replace(
                stamps_ns=truth.stamps_ns[kept], positions=truth.positions[kept], velocities=truth.velocities[kept]
            )
        },
    )


def test_a_recorded_robot_is_found_from_an_unknown_start(opened):
    """The robot of which least is heard, its first five minutes: the bounds of all (docs/consensus.md)."""
    source, recording = opened
    part = first_part(recording, 4, 300)
    run = mrclam.offline(source, part, mrclam.CONFIGURATION, target_id=4)
    row = mrclam.judge(run, part, 4)
    assert row['median_m'] <= 1.2
    assert row['found_median_m'] < 1.5
    assert row['best_median_m'] == pytest.approx(row['median_m'], abs=1e-6)  # all agree: three rounds reach everybody


def test_the_study_writes_every_robot(opened, tmp_path, monkeypatch):
    source, recording = opened
    part = first_part(recording, 4, 20)
    monkeypatch.setattr(mrclam, 'open_mrclam', lambda data: (source, part))
    assert mrclam.main([str(tmp_path), '-o', str(tmp_path)]) == 0
    told = json.loads((tmp_path / 'consensus_mrclam.json').read_text('utf-8'))['studies']['robots']
    assert list(told['robots']) == ['4']
    assert told['graph'] == {
        'radius_m': 5.5,
        'connected': True,
        'diameter': 3,
        'neighbours': told['graph']['neighbours'],
    }


def test_a_folder_without_the_set_is_one_clear_line(tmp_path, capsys):
    assert mrclam.main([str(tmp_path), '-o', str(tmp_path)]) == 1
    assert 'fetch mrclam' in capsys.readouterr().err

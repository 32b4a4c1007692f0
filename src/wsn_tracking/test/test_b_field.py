"""The random field of seed 002 as a world and as a recording."""

from dataclasses import replace

import numpy as np
import pytest

from wsn_tracking.bags.read import read
from wsn_tracking.bags.save import save
from wsn_tracking.errors import TrackingError
from wsn_tracking.models.graph import adjacency, is_connected
from wsn_tracking.models.range_bearing import wrapped
from wsn_tracking.sensing.values import EpochEnd, RangeBearing
from wsn_tracking.simulation import b_field as world
from wsn_tracking.simulation.b_field import FieldConfig, b_field
from wsn_tracking.simulation.record import record
from wsn_tracking.simulation.scenarios import scenario

SHORT = FieldConfig(epochs=8)


def packets(config, seed=3):
    """Readings (K, N, 2) of a recording, and what each node said of them."""
    told = [m for m in record(b_field(config), seed).messages if isinstance(m, RangeBearing)]
    z = np.array([[m.range, m.bearing] for m in told]).reshape(config.epochs, -1, 2)
    return z, np.array([m.arrived for m in told]).reshape(config.epochs, -1)


def true_readings(config):
    s = b_field(config)
    d = s.truth[:, None, :2] - s.anchors.positions[:, :2]
    return np.stack([np.hypot(d[..., 0], d[..., 1]), np.arctan2(d[..., 1], d[..., 0])], axis=-1)


def test_the_field_is_the_documents():
    s = scenario('b_field')
    assert s.anchors.ids.tolist() == list(range(1, 51))
    assert np.all((s.anchors.positions >= 0.0) & (s.anchors.positions <= [350.0, 400.0, 0.0]))
    assert is_connected(adjacency(s.anchors.positions, 100.0))
    assert (s.truth.shape, s.period, s.entry_level, s.configuration) == ((50, 4), 1.0, 'observation', 'consensus')


def test_walks_have_the_documents_moments():
    x = world.walks(FieldConfig(), 4000, np.random.default_rng(1))
    assert x[:, 0].mean(axis=0) == pytest.approx([50.0, 50.0, 10.0, 10.0], abs=0.5)
    assert x[:, 0].std(axis=0) == pytest.approx([10.0, 10.0, 3.0, 3.0], rel=0.04)
    F = np.eye(4) + np.diag([1.0, 1.0], 2)
    w = (x[:, 1:] - x[:, :-1] @ F.T).reshape(-1, 4)
    assert np.cov(w.T) == pytest.approx(np.kron([[1 / 3, 1 / 2], [1 / 2, 1.0]], np.eye(2)), abs=0.02)


def test_fields_are_drawn_until_they_are_connected():
    positions = world.fields(FieldConfig(), 12, np.random.default_rng(2))
    assert positions.shape == (12, 50, 3)
    assert np.all(is_connected(adjacency(positions, 100.0)))
    apart = world.fields(FieldConfig(radius=0.0, nodes=4), 200, np.random.default_rng(2))
    assert not np.all(is_connected(adjacency(apart, 100.0)))
    with pytest.raises(TrackingError, match='hardly ever connected at a radius of 20 m'):
        world.fields(FieldConfig(radius=20.0), 1, np.random.default_rng(2))


def test_what_arrives_is_range_and_bearing_with_their_noise():
    config = FieldConfig(fault_rate=0.0, repair_rate=1.0, first_rate=1.0)
    e = packets(config)[0] - true_readings(config)
    assert e[..., 0].std() == pytest.approx(0.1, rel=0.05)
    assert wrapped(e[..., 1]).std() == pytest.approx(0.5, rel=0.05)
    assert np.abs(packets(config)[0][..., 1]).max() <= np.pi


@pytest.mark.parametrize('faults', ['zero', 'clutter', 'absent'])
def test_the_same_readings_are_lost_whatever_they_read_then(faults):
    config = FieldConfig(faults=faults)
    z, arrived = packets(config)
    near = np.abs(z[..., 0] - true_readings(config)[..., 0]) < 0.6
    assert np.mean(near) == pytest.approx(0.4 / 0.45, abs=0.04)
    assert np.mean(near != packets(replace(config, faults='absent'))[1]) < 2e-3  # clutter may be near by chance
    lost = z[~near]
    if faults == 'zero':
        assert np.abs(lost[:, 0]).max() < 0.5
    elif faults == 'clutter':
        assert (lost[:, 0].max() > 500.0, lost[:, 0].min() >= 0.0) == (True, True)
        assert lost[:, 0].mean() == pytest.approx(300.0, abs=40.0)
    else:
        assert np.isnan(lost).all()
    assert np.all(arrived) == (faults != 'absent')


def test_a_node_that_dies_is_no_longer_listed():
    config = replace(SHORT, dead=(7, 9), dead_from=3)
    r, whole = record(b_field(config), 3), record(b_field(SHORT), 3)
    for k, end in enumerate(m for m in r.messages if isinstance(m, EpochEnd)):
        assert set(range(1, 51)) - set(end.node_ids) == (set() if k < 3 else {7, 9})
    others = [m for m in whole.messages if not isinstance(m, EpochEnd)]
    others = [m for m in others if not (isinstance(m, RangeBearing) and m.node_id in (7, 9) and m.request_seq >= 3)]
    assert others == [m for m in r.messages if not isinstance(m, EpochEnd)]


def test_seeds_of_field_and_readings_are_apart():
    one, two, moved = record(b_field(SHORT), 3), record(b_field(SHORT), 4), record(b_field(replace(SHORT, seed=2)), 3)
    assert repr(one.messages) == repr(record(b_field(SHORT), 3).messages)
    np.testing.assert_array_equal(one.anchors.positions, two.anchors.positions)
    assert one.messages != two.messages
    assert not np.array_equal(one.anchors.positions, moved.anchors.positions)


def test_parameters_come_by_name():
    s = scenario('b_field', {'nodes': 20, 'width': 200.0, 'depth': 250.0, 'epochs': 4})
    assert (s.anchors.ids.size, len(s.truth)) == (20, 4)
    with pytest.raises(TrackingError, match=r'`b_field` has no parameter `fault`: expected one of nodes, .*faults'):
        scenario('b_field', {'fault': 'zero'})
    with pytest.raises(TrackingError, match=r'`a_loop` has no parameter `nodes`: expected one of \(none\)'):
        scenario('a_loop', {'nodes': 20})
    with pytest.raises(TrackingError, match='`mean` and `std` take four numbers each'):
        scenario('b_field', {'mean': [1.0, 2.0]})
    with pytest.raises(TrackingError, match='expected one of zero, clutter, absent'):
        scenario('b_field', {'faults': 'never'})


def test_a_bag_gives_back_what_was_recorded(tmp_path):
    recording = record(b_field(replace(SHORT, faults='absent')), 3)
    save(tmp_path / 'bag', recording)
    back = read(tmp_path / 'bag')
    assert back.entry_level == 'observation'
    assert repr(back.messages) == repr(recording.messages)
    np.testing.assert_array_equal(back.anchors.positions, recording.anchors.positions)
    assert (back.metadata['scenario'], back.metadata['configuration']) == ('b_field', 'consensus')


def test_the_command_line_takes_parameters(call, tmp_path):
    words = ['--set', 'epochs=4', '--set', 'dead=[7]', '--set', 'dead_from=2']
    ended = call('simulate', 'b_field', '-o', tmp_path / 'bag', *words)
    assert ended.code == 0
    assert '206 messages' in ended.out  # 4 x (50 + 2), but for two of node 7's
    ends = [m for m in read(tmp_path / 'bag').messages if isinstance(m, EpochEnd)]
    assert [7 in end.node_ids for end in ends] == [True, True, False, False]
    for arguments, words in {
        ('--set', 'epochs'): 'expected name=value',
        ('--set', 'epochs=0'): 'expected an integer >= 1',
        ('--set', 'epochs=4', '--set', 'epochs=5'): '`epochs` is set twice',
        ('--set', 'dead=[7', '--live'): 'no readable YAML',
    }.items():
        ended = call('simulate', 'b_field', '-o', tmp_path / 'other', *arguments)
        assert (ended.code, ended.err.count('\n')) == (1, 1)
        assert words in ended.err


@pytest.mark.parametrize('nodes', [10, 400])
def test_a_grown_field_is_as_dense_and_of_the_same_shape(nodes):
    field, grown = FieldConfig(), world.grown(FieldConfig(), nodes)
    assert grown.nodes == nodes
    assert grown.nodes / (grown.width * grown.depth) == pytest.approx(field.nodes / (field.width * field.depth))
    assert grown.width / grown.depth == pytest.approx(field.width / field.depth)

"""The recorded bags: each is its scenario, but for how processors and NumPys round."""

from pathlib import Path

import numpy as np
import pytest

from live import ROOT
from wsn_tracking.bags.read import read
from wsn_tracking.simulation.record import record
from wsn_tracking.simulation.scenarios import scenario

ROUNDING = {'rtol': 1e-9, 'atol': 1e-9}  # functions differ in their last bits between processors; draws do not

BAGS = sorted(path.parent.name for path in Path(ROOT, 'bags').glob('*/metadata.yaml'))


def frame(message):
    """Everything but what was measured."""
    return type(message), [field for field in message if not isinstance(field, (float, tuple))]


def measured(message):
    """All numbers that are not whole."""
    for field in message:
        yield from [field] if isinstance(field, float) else field if isinstance(field, tuple) else []


@pytest.mark.parametrize('name', BAGS)
def test_a_bag_holds_what_its_scenario_and_seed_give(name):
    bag = read(Path(ROOT, 'bags', name))
    seed = int(bag.metadata['seed'])
    made = record(scenario(bag.metadata['scenario'], seed=seed), seed)
    assert bag.metadata['scenario'] == name
    assert bag.entry_level == made.entry_level
    assert {k: bag.metadata[k] for k in made.metadata} == made.metadata
    for target in made.truth:  # in the bag, messages of one instant are ordered by topic
        told, meant = ([m for m in recording.messages if m.target_id == target] for recording in (bag, made))
        assert [frame(m) for m in told] == [frame(m) for m in meant]
        np.testing.assert_allclose(*([x for m in ms for x in measured(m)] for ms in (told, meant)), **ROUNDING)
    assert len(bag.messages) == len(made.messages)
    np.testing.assert_allclose(bag.anchors.positions, made.anchors.positions, **ROUNDING)
    for target, truth in made.truth.items():
        assert bag.truth[target].stamps_ns.tolist() == truth.stamps_ns.tolist()
        np.testing.assert_allclose(bag.truth[target].positions, truth.positions, **ROUNDING)
        np.testing.assert_allclose(bag.truth[target].velocities, truth.velocities, **ROUNDING)


def test_every_bag_is_below_two_megabytes():
    people = {'c_circle', 'c_walk', 'c_corridor'}
    cells = {'d_stop', 'd_arc_stop', 'd_phase', 'd_dropout'}
    assert {'a_loop', 'a_circle', 'a_heading', *people, *cells, 'e_loss'} <= set(BAGS)
    for name in BAGS:
        assert sum(path.stat().st_size for path in Path(ROOT, 'bags', name).iterdir()) < 2e6

"""The recorded bags: each is its scenario, to the last bit."""

from pathlib import Path

import pytest

from live import ROOT
from wsn_tracking.bags.read import read
from wsn_tracking.simulation.record import record
from wsn_tracking.simulation.scenarios import scenario

BAGS = sorted(path.parent.name for path in Path(ROOT, 'bags').glob('*/metadata.yaml'))


@pytest.mark.parametrize('name', BAGS)
def test_a_bag_holds_what_its_scenario_and_seed_give(name):
    bag = read(Path(ROOT, 'bags', name))
    seed = int(bag.metadata['seed'])
    made = record(scenario(bag.metadata['scenario'], seed=seed), seed)
    assert bag.metadata['scenario'] == name
    assert bag.entry_level == made.entry_level
    assert {k: bag.metadata[k] for k in made.metadata} == made.metadata
    for target in made.truth:  # in the bag, messages of one instant are ordered by topic
        told, meant = (
            [repr(m) for m in recording.messages if m.target_id == target]  # NaN equals nothing, not even itself
            for recording in (bag, made)
        )
        assert told == meant
    assert len(bag.messages) == len(made.messages)
    assert bag.anchors.positions.tolist() == made.anchors.positions.tolist()
    for target, truth in made.truth.items():
        assert bag.truth[target].stamps_ns.tolist() == truth.stamps_ns.tolist()
        assert bag.truth[target].positions.tolist() == truth.positions.tolist()
        assert bag.truth[target].velocities.tolist() == truth.velocities.tolist()


def test_every_bag_is_below_two_megabytes():
    people = {'c_circle', 'c_walk', 'c_corridor'}
    cells = {'d_stop', 'd_arc_stop', 'd_phase', 'd_dropout'}
    assert {'a_loop', 'a_circle', 'a_heading', *people, *cells, 'e_loss'} <= set(BAGS)
    for name in BAGS:
        assert sum(path.stat().st_size for path in Path(ROOT, 'bags', name).iterdir()) < 2e6

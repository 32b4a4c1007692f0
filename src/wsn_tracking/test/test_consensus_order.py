"""What nodes tell each other does not depend on its order, is made of plain values, and belongs to nobody twice."""

import gc
import itertools

import numpy as np
import pytest
from consensus_cases import epoch_of, network_of
from consensus_field import POSITIONS, SCHEMES, Z, epochs
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles import properties

from wsn_tracking.trackers.consensus_config import ConsensusConfig
from wsn_tracking.trackers.consensus_network import run_epoch
from wsn_tracking.trackers.consensus_share import bitmap, ids_of, to_bytes


def deliver(nodes, k, order):
    """One epoch in which every node's shares arrive in the order that `order` gives."""
    said = {i: node.begin(epoch_of(k, Z[k])) for i, node in nodes.items()}
    while any(said.values()):
        for node in nodes.values():
            for j in order([j for j in node.neighbours if said[j]]):
                node.receive(said[j])
        said = {i: node.advance() for i, node in nodes.items()}
    return [node.finish() for node in nodes.values()]


@settings(properties, max_examples=10)
@given(st.sampled_from(SCHEMES), st.randoms(use_true_random=False))
def test_estimates_do_not_depend_on_neighbour_order(scheme, random):
    """Not even in the last bit."""
    config = ConsensusConfig(scheme=scheme, rounds=12)
    plain, shuffled = network_of(config, POSITIONS), network_of(config, POSITIONS)
    for k in range(2):
        first = deliver(plain, k, list)
        second = deliver(shuffled, k, lambda ids: random.sample(ids, len(ids)))
        for a, b in zip(first, second, strict=True):
            assert (a.mean.tobytes(), a.covariance.tobytes()) == (b.mean.tobytes(), b.covariance.tobytes())


def arrays_of(thing):
    """Every array that an object can reach, but those of modules, classes and functions."""
    found, seen, queue = [], set(), [thing]
    while queue:
        item = queue.pop()
        if id(item) in seen or isinstance(item, type) or callable(item) or type(item).__name__ == 'module':
            continue
        seen.add(id(item))
        if isinstance(item, np.ndarray):
            found.append(item)
        queue += gc.get_referents(item)
    return found


@pytest.mark.parametrize('scheme', ['icf', 'flood'])
def test_no_array_is_shared_between_nodes(scheme):
    """In the middle of an epoch, with shares held; what they share is what they were made of, the table of anchors."""
    nodes = network_of(ConsensusConfig(scheme=scheme, rounds=6), POSITIONS)
    run_epoch(nodes, epochs(0))
    said = {i: node.begin(epoch_of(1, Z[1])) for i, node in nodes.items()}
    for node in nodes.values():
        for j in node.neighbours:
            node.receive(said[j])
    for node in nodes.values():
        node.advance()
    owned = {i: arrays_of(node) for i, node in nodes.items()}
    assert all(len(arrays) > 5 for arrays in owned.values())
    for i, j in itertools.combinations(nodes, 2):
        assert not any(
            np.shares_memory(a, b) for a in owned[i] for b in owned[j] if a.flags.writeable or b.flags.writeable
        )


def test_a_share_holds_plain_values():
    node = network_of(ConsensusConfig(), POSITIONS)[3]
    share = node.begin(epoch_of(0, Z[0]))
    assert {type(field) for field in share} <= {int, str, bytes, tuple}
    assert {type(number) for number in share.information_vector + share.information} == {float}
    assert (len(share.information_vector), len(share.information)) == (4, 10)
    assert share[:5] == (0, 1, 0, 0, 3)
    assert (share.scheme, share.degree, ids_of(int.from_bytes(share.live, 'little'))) == (
        'icf',
        len(node.neighbours),
        (3,),
    )


@given(st.sets(st.integers(0, 65535), max_size=20))
@properties
def test_a_bitmap_is_the_set_of_its_ids(ids):
    data = to_bytes(bitmap(ids))
    assert {8 * at + bit for at, byte in enumerate(data) for bit in range(8) if byte >> bit & 1} == ids
    assert set(ids_of(int.from_bytes(data, 'little'))) == ids

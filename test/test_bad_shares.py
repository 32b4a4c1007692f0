"""Bad shares beside good ones, on the topics of a running consensus_node: counted, and never in an estimate."""

from __future__ import annotations

from collections import Counter
from functools import partial

import pytest
from diagnostic_msgs.msg import DiagnosticArray
from wsn_tracking_msgs import msg

from feeding import Feed
from live import private_domain, started
from observer import observing
from wsn_tracking.evaluation.run import epochs_of
from wsn_tracking.evaluation.run_consensus import run_consensus
from wsn_tracking.graphs import Process
from wsn_tracking.graphs.consensus import districts
from wsn_tracking.nodes import convert, qos
from wsn_tracking.sensing.recording import epoch_key
from wsn_tracking.sensing.values import RangeBearing
from wsn_tracking.simulation.b_field import FieldConfig, b_field
from wsn_tracking.simulation.record import record
from wsn_tracking.trackers.consensus_config import ConsensusConfig
from wsn_tracking.trackers.consensus_group import ConsensusGroup
from wsn_tracking.trackers.consensus_node import ConsensusNode
from wsn_tracking.trackers.consensus_share import Share

TIMEOUT = 60.0  # [s]
EPOCHS = 5
NAN, INF = float('nan'), float('inf')


def scaled(share, factor):
    """A share all of whose numbers are multiplied."""
    names = ('information_vector', 'information', 'items')
    return share._replace(**{name: tuple(factor * x for x in getattr(share, name)) for name in names})


def refused(share):
    """What no node can have said in place of this."""
    yield from (scaled(share, factor) for factor in (NAN, INF, -1.0, 1e300))
    yield share._replace(information=share.information[:-1], items=share.items[:-1])
    yield share._replace(items=(0.0,) * 14 * 500, item_ids=(7,) * 500)
    yield share._replace(scheme='hcmci')
    yield share._replace(round=65535)
    yield share._replace(degree=65535)
    yield share._replace(live=b'\xff' * 60_000)
    yield share._replace(node_id=share.node_id % 65535 + 1)  # another one's, on this node's topic


def dropped(share):
    """Of other epochs than that which is going on."""
    yield share._replace(request_seq=share.request_seq + 1000)
    yield share._replace(target_id=9)
    yield share._replace(stamp_ns=0)
    yield share._replace(stamp_ns=2**31 * 10**9 - 1, request_seq=2**32 - 1)


class Others:
    """The nodes that live in the test; each of their good shares goes out behind many bad ones."""

    def __init__(self, nodes, node):
        self.group = ConsensusGroup(nodes, TIMEOUT)
        self.refused = {i: 0 for i, each in nodes.items() if not nodes.keys() >= set(each.neighbours)}  # heard outside
        self.outputs = {i: node.create_publisher(msg.ConsensusShare, topic_of(i), qos.ESTIMATES) for i in self.refused}
        for i in self.group.foreign:
            node.create_subscription(msg.ConsensusShare, topic_of(i), self.hear, qos.ESTIMATES)

    def begin(self, epoch):
        self.group.begin(epoch)
        self.say()

    def hear(self, message):
        self.group.receive(self.group.door.check(convert.share_value(message)))
        self.say()

    def say(self):
        for said in self.group.advance(0.0):
            if isinstance(said, Share) and said.node_id in self.outputs:
                bad = [share for share in refused(said) if share != said]  # a share may hold no number to spoil
                self.refused[said.node_id] += len(bad)
                for share in (*bad, *dropped(said), said):
                    self.outputs[said.node_id].publish(convert.share_message(share))


def topic_of(i):
    return f'consensus/node_{i}'


@pytest.mark.parametrize('scheme', ['icf', 'flood'])
def test_bad_shares_are_counted_and_change_not_a_bit(scheme):
    """Half of the nodes live in a process, the others in the test."""
    recording = record(b_field(FieldConfig(nodes=6, width=120.0, depth=140.0, epochs=EPOCHS)), 3)
    config = ConsensusConfig(scheme=scheme, rounds=4)
    inside, outside = districts(recording.anchors, 2)
    timing = {'round_timeout': TIMEOUT, 'loss_timeout': TIMEOUT, 'input': 'observation', 'ids': list(inside)}
    process = Process('consensus_node', 'consensus', {'scheme': scheme, 'rounds': config.rounds, **timing})
    with private_domain() as environment, observing(environment) as observer, started([process], environment) as run:
        feed = Feed(observer, recording.anchors, RangeBearing)
        others = Others({i: ConsensusNode(config, recording.anchors, i) for i in outside}, observer.node)
        told = observer.collect(DiagnosticArray, '/diagnostics', qos.ESTIMATES)
        seen = {i: observer.collect(msg.TargetEstimate, f'estimate/consensus_{i}', qos.ESTIMATES) for i in inside}
        feed.until_heard(TIMEOUT)
        for output in others.outputs.values():
            observer.until(partial(output.get_subscription_count), TIMEOUT, output.topic_name)
        for i in inside:
            observer.until(partial(observer.node.count_publishers, f'estimate/consensus_{i}'), TIMEOUT, f'node {i}')
        for k, epoch in enumerate(epochs_of(recording, 1, Counter(), lambda: None), 1):
            feed.send(*(m for m in recording.messages if epoch_key(m)[1] == epoch.request_seq))
            others.begin(epoch)
            observer.until(lambda k=k: {len(e) for e in seen.values()} == {k}, TIMEOUT, f'all estimates of epoch {k}')
        told.clear()
        observer.until(lambda: told, TIMEOUT, 'diagnostics')
        assert run['consensus'].poll() is None
    offline = run_consensus(recording, config).estimates
    for i, estimates in seen.items():
        for one, other in zip(estimates, offline[f'consensus_{i}'], strict=True):
            assert (one.mean.tobytes(), one.covariance.tobytes()) == (other.mean.tobytes(), other.covariance.tobytes())
    values = {p.key: p.value for p in told[-1].status[0].values}
    assert {i: int(values[f'malformed.{topic_of(i)}']) for i in others.refused} == others.refused
    assert min(others.refused.values()) > 8 * EPOCHS * config.rounds
    assert int(values['dropped.foreign_epoch']) >= 3 * EPOCHS * config.rounds

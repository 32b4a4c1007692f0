"""Faults of the air and of the nodes: repeated, overtaken, lost, foreign, wrapped, rebooted."""

import itertools

import pytest
from fault_cases import ALL, judged, ran, strikes
from zstack_cases import is_subsequence

from wsn_tracking.zstack import commands as c

# ---- the air


@pytest.mark.parametrize('fault', ['duplicates=0.5', 'relayed=0.5'])
def test_repeated_messages_are_the_same_messages(fault):
    host = ran(fault)
    counters, heard = judged(host)
    assert heard == ALL
    assert counters == {'duplicates': strikes(host)}
    assert len(host.reports) == len(ALL) + strikes(host)


def test_relayed_broadcasts_come_by_another_way():
    host = ran('relayed=1')
    ways = {(r.payload.node_id, r.payload.seq): set() for r in host.reports}
    for report in host.reports:
        ways[report.payload.node_id, report.payload.seq].add((report.mac_src, report.hops))
    assert {len(way) for way in ways.values()} == {2}


def test_overtaken_messages_come_after_their_successor_and_none_is_lost():
    host = ran('reorder=0.3')
    counters, heard = judged(host)
    assert heard == ALL
    assert set(counters) == {'reordered'}
    assert counters['reordered'] >= 0.8 * strikes(host)


def test_lost_messages_leave_gaps_in_the_numbers():
    host = ran('lost=0.2')
    counters, heard = judged(host)
    assert len(heard) == len(ALL) - strikes(host)
    assert 0 < counters['lost_messages'] <= strikes(host)


def test_damaged_payloads_are_rejected():
    host = ran('payload_crc=0.2')
    assert len(host.bad()) == strikes(host) == len(ALL) - len(host.heard())
    assert set(host.bad()) <= {'payload_crc', 'payload_length', 'payload_version'}


@pytest.mark.parametrize(
    ('fault', 'reason'),
    [
        ('unknown_version', 'payload_version'),
        ('foreign_cluster', 'foreign_cluster'),
        ('foreign_endpoint', 'foreign_endpoint'),
    ],
)
def test_strangers_are_told_apart(fault, reason):
    host = ran(f'{fault}=0.3')
    assert host.heard() == ALL
    assert host.bad() == [reason] * strikes(host)


@pytest.mark.parametrize('protocol', ['mt_app', 'ascii'])
@pytest.mark.parametrize('fault', ['unknown_version', 'foreign_cluster', 'foreign_endpoint', 'payload_crc', 'lost'])
def test_faults_of_the_air_on_the_other_sinks(fault, protocol):
    host = ran(f'{fault}=0.3', sink_protocol=protocol)
    lost = strikes(host) if fault in {'payload_crc', 'lost'} else 0
    assert len(host.reports) == len(ALL) - lost


def test_second_radio_with_the_same_id_is_a_conflict():
    host = ran('two_addresses=0.5')
    counters, heard = judged(host)
    assert counters['address_conflicts'] > 10
    assert is_subsequence(ALL, heard)
    sources = {node: {r.src for r in host.reports if r.payload.node_id == node} for node in range(1, 7)}
    assert sorted({len(s) for s in sources.values()}) == [1, 2]


# ---- the nodes


def test_numbers_and_clocks_wrap_without_a_trace():
    host = ran('wraps=10')
    counters, heard = judged(host)
    assert (counters, heard) == ({}, ALL)
    for wrapped in (
        [r.ticks for r in host.reports],
        *([getattr(r.payload, f) for r in host.reports if r.payload.node_id == 1] for f in ('seq', 't_ms')),
    ):
        assert min(wrapped) < 1000
        assert sum(b < a - 1000 for a, b in itertools.pairwise(wrapped)) == 1


def test_rebooted_nodes_begin_anew():
    host = ran('reboot=10')
    counters, heard = judged(host)
    assert heard == ALL
    assert counters == {'node_restarts': strikes(host)}


def test_rejoined_nodes_have_other_addresses_and_are_announced():
    host = ran('rejoin=10')
    counters, heard = judged(host)
    assert heard == ALL
    assert counters == {'address_changes': strikes(host)}
    announced = {told.short for told in host.of(c.ZdoEndDeviceAnnceInd)}
    assert len(announced) == strikes(host)
    assert announced <= {r.src for r in host.reports}

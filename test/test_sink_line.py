"""What a link to a sink must survive, each group (zstack.md, section 7) on a pseudo terminal with a simulated sink.

| group | test |
|---|---|
| garbage, boot text, partial frames, single bytes, many at once | `test_line_that_damages_no_frame_loses_nothing` |
| bad FCS, LEN > 250, corrupted LEN | `test_damaged_frame_is_lost_alone` |
| sink reset in mid-run | `test_reset_in_mid_run_loses_nothing` |
| unplug and replug under another name | `test_replug_under_another_name_is_found` |
| a mute sink | `test_mute_sink_is_opened_again` |
| stale input at open | `test_stale_input_is_not_taken` |
| duplicates by APS retry and by relayed broadcasts | `test_repeated_messages_count_once` |
| reordering | `test_overtaken_messages_are_kept` |
| lost seq | `test_lost_messages_are_counted_by_their_numbers` |
| wraps of seq, t_ms and the sink clock | `test_wraps_leave_no_trace` |
| node reboot | `test_rebooted_nodes_are_new_and_no_duplicates` |
| the same node_id from a new address | `test_rejoined_nodes_go_on` |
| the same node_id from two addresses at once | `test_two_radios_of_one_id_are_a_conflict` |
| RPC error, missing and late SRSP | `test_host_gets_there_in_spite_of_bad_answers` |
| payload CRC, unknown version, foreign cluster or endpoint | `test_what_is_not_ours_is_counted_and_ignored` |
| a full host queue | `test_full_queue_drops_the_oldest` |
| a port opened twice | `test_second_host_is_kept_out_and_a_restarted_one_is_served` |
"""

from __future__ import annotations

import dataclasses
import os

import pytest
from sink_cases import epochs, expected

from radio import PATIENT, measured, until
from wsn_tracking.errors import TrackingError
from wsn_tracking.zstack.faults import Event, Happening
from wsn_tracking.zstack.payload import PayloadType
from wsn_tracking.zstack.port import open_port
from wsn_tracking.zstack.reports import Report

RATE = 60.0
PART = 10
WORLD = epochs(3 * PART, nodes=6)
ALL = expected(WORLD)
PARTS = [WORLD[k * PART : (k + 1) * PART] for k in range(3)]


@pytest.fixture
def radio(radio):
    """Starts sinks that tell of this world, with these faults."""
    quick = {'rate': RATE, 'fault_time': 0.5}
    return lambda *faults, world=WORLD, **config: radio(world, faults=faults, **{**quick, **config})


def strikes(radio):
    return sum(fault.strikes for fault in radio.simulator.faults)


def patient(**changes):
    return dataclasses.replace(PATIENT, **changes)


# ---- the line


@pytest.mark.parametrize(
    'fault', ['garbage=0.5', 'boot_text=0.5', 'partial=0.3', 'byte_at_a_time', 'batch=7', 'long_len=0.5']
)
def test_line_that_damages_no_frame_loses_nothing(radio, host, fault):
    sink = radio(fault)
    assert host().through(sink).measured == ALL
    assert strikes(sink)


@pytest.mark.parametrize(
    ('fault', 'counter'),
    [('bad_fcs=0.1', 'bad_fcs'), ('corrupted_len=0.1', 'garbage_bytes'), ('cut=0.05', 'garbage_bytes')],
)
def test_damaged_frame_is_lost_alone(radio, host, fault, counter):
    sink = radio(fault)
    heard = host(timeout=patient(gap=0.1, reply=0.5, ping=0.5, startup=1.0, commissioning=1.0)).through(sink)
    assert set(heard.measured) <= set(ALL)
    assert len(ALL) - strikes(sink) <= len(heard.measured) < len(ALL)
    assert heard.counters[counter]
    assert heard.counters['lost'] == heard.counters['duplicates'] == 0


def test_stale_input_is_not_taken(radio, host):
    sink = radio('stale', 'boot_text=0')
    heard = host().through(sink)
    assert heard.measured == ALL
    kinds = {item.payload.type for item, _ in heard.received if isinstance(item, Report)}
    assert kinds == {PayloadType.RSSI}  # the stale messages were heartbeats


# ---- outages


def fall_out(sink, heard, event, seconds, back):
    """An outage as the second part of the world begins; `back()` holds when it is over, then comes the third part."""
    heard.through(sink)
    sink.do(lambda s, now: (s.happen(Happening(event, seconds), now), s.go_on(PARTS[1], now)))
    back()
    until(lambda: sink.loop.finished and sink.simulator.delivers, 'the sink is back')
    sink.do(lambda s, now: s.go_on(PARTS[2], now))
    heard.after(sink)
    assert heard.measured == measured(sink.given)  # nothing of what the line delivered is lost
    assert set(expected(PARTS[0])) | set(expected(PARTS[2])) <= set(heard.measured)
    assert not set(heard.measured) & set(expected(PARTS[1][:1]))  # the outage was one


def test_reset_in_mid_run_loses_nothing(radio, host):
    sink, heard = radio(world=PARTS[0]), host()
    fall_out(sink, heard, Event.RESET, 0.0, lambda: heard.until_up(2))
    assert (heard.counters['resets'], heard.counters['lost'], heard.counters['attached']) == (1, 0, 2)


def test_replug_under_another_name_is_found(radio, host, link):
    sink, heard = radio(world=PARTS[0]), host()
    until(lambda: heard.events('up'), 'the link')
    before = os.path.realpath(link)
    fall_out(sink, heard, Event.UNPLUG, 0.2, lambda: heard.until_up(2))
    assert heard.events('opened') == [before, os.path.realpath(link)]
    assert before != os.path.realpath(link)
    assert heard.events('lost')


def test_mute_sink_is_opened_again(radio, host):
    sink, heard = radio(world=PARTS[0]), host(timeout=patient(misses=1))

    def back():
        until(lambda: heard.events('lost'), 'the silence is noticed')
        sink.do(lambda s, now: s.happen(Happening(Event.MUTE, 0.0), now))  # it finds its voice again
        heard.until_up(2)

    fall_out(sink, heard, Event.MUTE, 1e6, back)
    assert 'has not answered' in heard.events('lost')[0]


# ---- the air


@pytest.mark.parametrize('fault', ['duplicates=0.3', 'relayed=0.3'])
def test_repeated_messages_count_once(radio, host, fault):
    sink = radio(fault)
    heard = host().through(sink)
    assert heard.measured == ALL
    assert heard.counters['duplicates'] == strikes(sink) > 0


def test_overtaken_messages_are_kept(radio, host):
    sink = radio('reorder=0.2')
    heard = host().through(sink)
    assert heard.measured == ALL
    assert heard.counters['reordered'] > 0
    assert heard.counters['duplicates'] == heard.counters['lost_messages'] == 0


def test_lost_messages_are_counted_by_their_numbers(radio, host):
    """Within what a node was heard of; the numbers travel on in `seq` of its measurements, for who wants them."""
    sink = radio('lost=0.2')
    heard = host().through(sink)
    assert heard.measured == measured(sink.given)
    numbers = {}
    for payload in sink.given:
        numbers.setdefault(payload.node_id, []).append(payload.seq)
    gaps = sum(max(seqs) - min(seqs) + 1 - len(seqs) for seqs in numbers.values())
    assert heard.counters['lost_messages'] == gaps > 0


def test_wraps_leave_no_trace(radio, host):
    sink = radio('wraps=1', rate=20.0)
    heard = host().through(sink)
    assert heard.measured == ALL
    reports = [item for item, _ in heard.received if isinstance(item, Report)]
    assert {r.payload.seq for r in reports} >= {0xFFFF, 0}
    assert min(r.payload.t_ms for r in reports) < 1 << 16 < 1 << 31 < max(r.payload.t_ms for r in reports)
    wrong = ('duplicates', 'lost_messages', 'node_restarts', 'clock_restarts', 'clock_strange', 'late_messages')
    assert not [name for name in wrong if heard.counters[name]]


def test_rebooted_nodes_are_new_and_no_duplicates(radio, host):
    sink = radio('reboot=15')
    heard = host().through(sink)
    assert heard.measured == ALL
    assert heard.counters['node_restarts'] == strikes(sink) > 0
    assert heard.counters['duplicates'] == 0


def test_rejoined_nodes_go_on(radio, host):
    sink = radio('rejoin=15')
    heard = host().through(sink)
    assert heard.measured == ALL
    assert heard.counters['address_changes'] == strikes(sink) > 0
    assert heard.counters['address_conflicts'] == heard.counters['node_restarts'] == 0


def test_two_radios_of_one_id_are_a_conflict(radio, host):
    sink = radio('two_addresses=0.5')
    heard = host().through(sink)
    assert heard.measured == measured(sink.given)
    assert len(heard.measured) > len(ALL)
    assert heard.counters['address_conflicts'] > 0


@pytest.mark.parametrize(
    ('fault', 'counters'),
    [
        ('payload_crc=0.2', ['payload_crc', 'payload_length', 'payload_version']),
        ('unknown_version=0.3', ['payload_version']),
        ('foreign_cluster=0.3', ['foreign_cluster']),
        ('foreign_endpoint=0.3', ['foreign_endpoint']),
    ],
)
def test_what_is_not_ours_is_counted_and_ignored(radio, host, fault, counters):
    sink = radio(fault)
    heard = host().through(sink)
    rejected = sum(heard.counters[name] for name in counters)
    assert rejected == strikes(sink) > 0
    if fault.startswith('payload_crc'):
        assert len(heard.measured) == len(ALL) - rejected
        assert set(heard.measured) <= set(ALL)
    else:
        assert heard.measured == ALL


# ---- the host


@pytest.mark.parametrize(
    ('fault', 'counter'),
    [('rpc_error=0.3', 'rpc_errors'), ('missing_reply=0.3', 'no_answers'), ('late_reply=0.3', 'late_answers')],
)
def test_host_gets_there_in_spite_of_bad_answers(radio, host, fault, counter):
    sink = radio(fault, seed=2)
    heard = host(timeout=patient(reply=0.2, ping=0.2, startup=0.5)).through(sink)
    assert heard.measured == ALL
    until(lambda: heard.counters[counter], f'{counter}, as the pings go on')
    assert len(heard.events('up')) >= 1


def test_sink_that_answers_slowly_is_waited_for(radio, host):
    """Each answer takes a while, but less than the timeout: nothing is asked twice, and no answer counts as late."""
    sink = radio('late_reply=1', fault_time=0.1)
    heard = host(timeout=patient(reply=30.0, ping=30.0)).through(sink)
    assert heard.measured == ALL
    assert strikes(sink) > 8
    wrong = ('no_answers', 'late_answers', 'repeated_requests', 'pings_missed', 'lost', 'open_failed')
    assert not [name for name in wrong if heard.counters[name]]


def test_full_queue_drops_the_oldest(radio, host):
    sink, heard = radio(), host(host_queue=10)
    heard.until_up()
    heard.received.clear()
    sink.may_begin.set()
    until(lambda: heard.session.counters['reports'] == len(ALL), 'all reports, which nobody takes')
    heard.take()
    assert [item.payload for item, _ in heard.received] == sink.given[-10:]
    assert heard.counters['host_queue_dropped'] == len(ALL) - 10


def test_second_host_is_kept_out_and_a_restarted_one_is_served(radio, host, link):
    sink, first = radio(), host()
    first.through(sink)
    with pytest.raises(TrackingError, match='in use'):
        open_port(str(link), 115200, 1.0)
    first.session.close()
    second = host()
    second.until_up()
    sink.do(lambda s, now: s.go_on(PARTS[0], now))
    assert second.after(sink).measured == expected(PARTS[0])
    assert sink.simulator.device.chip.counters['undelivered'] == 0  # its network stayed up, and the endpoint known

"""Each fault of a simulated sink does what it says, to the host of this project, and nothing else."""

import itertools
from pathlib import Path

import pytest
from sink_cases import Host, epochs, expected
from zstack_cases import is_subsequence, line_bytes

from wsn_tracking.errors import TrackingError
from wsn_tracking.zstack import commands as c
from wsn_tracking.zstack.clock import ClockConfig
from wsn_tracking.zstack.faults import FAULTS, parse_faults
from wsn_tracking.zstack.faults.on_line import BOOT_TEXT
from wsn_tracking.zstack.intake import Intake
from wsn_tracking.zstack.lqi import SCALES
from wsn_tracking.zstack.queues import Received
from wsn_tracking.zstack.simulator import Plug

WORLD = epochs(30, nodes=6)
ALL = expected(WORLD)


def ran(*faults, world=None, **config):
    return Host(WORLD if world is None else world, faults=faults, **config).run()


def judged(host):
    """Counters of the intake, and the measurements that are new."""
    intake = Intake(ClockConfig(), SCALES['cc2530'])
    received = [Received(item, round(t * 1e9)) for item, t in zip(host.items, host.times, strict=True)]
    new = [t.report.payload for t in map(intake.take, received) if t is not None and t.is_new]
    heard = sorted((p.node_id, r.beacon_seq, r.rssi_dbm) for p in new for r in p.records)
    return {name: n for name, n in intake.counters.items() if n}, heard


def strikes(host):
    return sum(fault.strikes for fault in host.simulator.faults)


def writes(host):
    return [action for _, action in host.actions if isinstance(action, bytes)]


HARMLESS = ['garbage=0.5', 'boot_text=0.5', 'partial=0.5', 'byte_at_a_time', 'long_len=0.5', 'batch=5', 'stale']


@pytest.mark.parametrize('fault', HARMLESS)
@pytest.mark.parametrize('seed', [0, 1])
def test_nothing_is_lost_by_what_damages_no_frame(fault, seed):
    host = ran(fault, seed=seed)
    assert is_subsequence(ALL, host.heard())
    assert judged(host)[1] == ALL
    assert strikes(host) > 0


@pytest.mark.parametrize('fault', ['bad_fcs=0.1', 'corrupted_len=0.1', 'cut=0.1'])
@pytest.mark.parametrize('seed', [0, 1])
def test_damaged_frames_are_lost_and_no_others(fault, seed):
    host = ran(fault, seed=seed)
    struck = strikes(host)
    assert struck > 5
    counters, heard = judged(host)
    assert len(ALL) - struck <= len(heard) < len(ALL)
    assert is_subsequence(heard, ALL)
    assert set(counters) <= {'lost_messages'}


def test_bytes_come_one_at_a_time():
    assert {len(write) for write in writes(ran('byte_at_a_time'))} == {1}


def test_frames_come_several_at_a_time():
    host = ran('batch=4', world=epochs(30, nodes=8))
    frames = [write.count(b'\xfe\x2a\x44\x81') for write in writes(host)]
    assert max(frames) >= 3
    assert host.simulator.faults[0].strikes > 30


def test_pieces_of_a_frame_are_apart_but_less_than_a_gap():
    host = ran('partial=1')
    times = [t for t, action in host.actions if isinstance(action, bytes)]
    pauses = [b - a for a, b in itertools.pairwise(times) if b > a]
    assert min(pauses) < 0.05
    assert host.protocol.counters['gaps'] == 0


def test_broken_off_frame_is_followed_by_a_pause():
    host = ran('cut=0.2')
    assert host.protocol.counters['gaps'] > 5


def test_boot_text_and_stale_input_are_there_at_the_plug():
    host = Host(WORLD, faults=('boot_text=0', 'stale'))
    host.until(host.now)
    (said,) = writes(host)
    assert BOOT_TEXT in said
    assert len(host.reports) == 3  # old ones; the host drops what comes before it asks


def test_wrong_check_in_lines_of_text():
    host = ran('bad_fcs=0.3', sink_protocol='ascii')
    assert set(host.bad()) == {'line_checksum'}
    assert len(host.reports) + len(host.bad()) == len(ALL)


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


def test_second_radio_with_the_same_id():
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


# ---- the sink


def test_reset_in_mid_run_silences_it_until_it_is_registered_again():
    host = Host(WORLD, faults=('reset=5',))
    host.attach()
    host.simulator.begin(host.now)
    host.until(host.now + 9.5)
    assert len(host.of(c.SysResetInd)) == 1
    assert {r.payload.seq for r in host.reports} == set(range(5))
    host.attach()
    host.until(host.now + 30.0)
    assert {r.payload.seq for r in host.reports} == {*range(5), *range(10, 30)}


def test_unplugged_sink_comes_back_as_after_power_up():
    host = Host(WORLD, faults=('unplug=5',), fault_time=3.0)
    host.attach()
    host.simulator.begin(host.now)
    begun = host.now
    host.until(begun + 8.5)
    assert [item for item in host.items if isinstance(item, Plug)] == [Plug.IN, Plug.OUT, Plug.IN]
    assert host.items[-1] == c.SysResetInd(0, 2, 0, 2, 6, 3)
    host.attach()
    host.until(begun + 40.0)
    assert {r.payload.seq for r in host.reports} == {*range(5), *range(9, 30)}
    assert host.simulator.finished


def test_mute_sink_is_deaf_too_and_forgets_nothing():
    host = Host(WORLD, faults=('mute=5',), fault_time=3.0)
    host.attach()
    host.simulator.begin(host.now)
    host.until(host.now + 6.0)
    said = len(host.items)
    host.say(c.SysPing())
    host.until(host.now + 1.0)
    assert len(host.items) == said
    host.until(host.now + 30.0)
    assert {r.payload.seq for r in host.reports} == {*range(5), *range(8, 30)}
    host.say(c.SysPing())
    assert host.items[-1] == c.SysPingRsp(0x0179)


def test_refused_requests_are_not_done():
    host = Host(faults=('rpc_error=1',))
    host.attach()
    assert host.of(c.RpcError) == [c.RpcError(2, 0x25, 0x40), c.RpcError(2, 0x24, 0x00)]
    assert not host.simulator.delivers


def test_sink_without_network_information():
    host = Host(faults=('no_network_info',))
    host.attach()
    host.say(c.ZdoExtNwkInfo(), c.SysPing())
    assert host.items[-2:] == [c.RpcError(2, 0x25, 0x50), c.SysPingRsp(0x0179)]
    assert host.simulator.delivers


def test_missing_answers_were_given_all_the_same():
    host = Host(faults=('missing_reply=1',))
    host.attach()
    assert host.simulator.delivers
    assert [type(item) for item in host.items[1:]] == [c.ZdoStateChangeInd]


def test_late_answers_come_late():
    host = Host(faults=('late_reply=1',), fault_time=4.0)
    host.until(host.now)
    asked_at = host.now
    host.say(c.SysPing())
    host.until(asked_at + 3.9)
    assert host.of(c.SysPingRsp) == []
    host.until(asked_at + 4.1)
    assert len(host.of(c.SysPingRsp)) == 1


# ---- all of them


def test_faults_are_seeded():
    faults = tuple(name for name in FAULTS if name not in {'unplug', 'mute', 'reset'})
    one, same, other = (ran(*faults, seed=seed).actions for seed in (5, 5, 6))
    assert one == same
    assert one != other


@pytest.mark.parametrize('name', [name for name, kind in FAULTS.items() if kind.value == 'share'])
def test_a_fault_that_is_switched_off_changes_nothing(name):
    switched, plain = ran(f'{name}=0').actions, ran().actions
    if name in {'stale', 'boot_text'}:
        switched.pop(1)
    assert switched == plain


def test_page_lists_every_fault_with_its_default():
    page = (Path(__file__).parents[3] / 'docs' / 'sink_simulator.md').read_text('utf-8')
    listed = [line.split('|')[1:4] for line in page.splitlines() if line.startswith('| `')]
    assert [tuple(cell.strip(' `') for cell in cells) for cells in listed] == [
        (name, kind.value, f'{kind.default:g}') for name, kind in FAULTS.items()
    ]


@pytest.mark.parametrize('text', ['nonsense', 'lost=2', 'lost=x', 'lost=-0.1', 'reset=1.5', 'reset=nan', 'lost='])
def test_what_is_no_fault_is_refused(text):
    with pytest.raises(TrackingError, match='expected'):
        parse_faults([text], 1.0, 0)


def test_everything_at_once_never_raises_and_ends():
    host = Host(WORLD, faults=tuple(FAULTS), fault_time=0.5)
    for _ in range(10):
        host.say(c.ZdoStartup(100), c.SysPing(), c.AfRegister(0xE8, 0xBF01, in_clusters=(0x10,)))
        host.until(host.now + 0.3)
    host.simulator.begin(host.now)
    for _ in range(60):
        host.say(line_bytes(c.ZdoStartup(100)), c.AfRegister(0xE8, 0xBF01, in_clusters=(0x10,)))
        host.until(host.now + 1.0)
    assert len(host.simulator.sent) == len(WORLD)
    assert host.reports

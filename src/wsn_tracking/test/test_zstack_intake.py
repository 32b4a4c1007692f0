import pytest
from zstack_cases import report_payload

from wsn_tracking.zstack.clock import ClockConfig
from wsn_tracking.zstack.commands import SysResetInd
from wsn_tracking.zstack.intake import COUNTERS, Intake
from wsn_tracking.zstack.link import LinkEvent
from wsn_tracking.zstack.lqi import SCALES
from wsn_tracking.zstack.payload import Flag
from wsn_tracking.zstack.queues import Received
from wsn_tracking.zstack.reports import Report

S = 1_000_000_000
MS = 1_000_000


class Host:
    def __init__(self):
        self.intake = Intake(ClockConfig(), SCALES['cc2530'])

    def hear(self, seq=1, t=0.0, delay=0.002, ticks_from=0.0, lqi=105, src=0x10, **more):
        ticks = int((t - ticks_from) / 320e-6)
        payload = report_payload(seq=seq, t_ms=int(1000 * t), **more)
        return self.intake.take(Received(Report(payload, src, lqi, 1, ticks, src), int((1000 + t + delay) * S)))

    @property
    def counted(self):
        return {name: n for name, n in self.intake.counters.items() if n}


def test_duplicates_are_marked_and_counted_and_keep_the_time_of_their_reception():
    host = Host()
    host.hear(1, 0.0)
    first, again = host.hear(2, 1.0, 0.05), host.hear(2, 1.0, 0.3)
    assert (first.is_new, again.is_new) == (True, False)
    assert abs(first.time_ns - again.time_ns) < MS / 10
    assert abs(first.time_ns - int(1001.002 * S)) < MS
    assert host.counted == {'duplicates': 1}


def test_everything_is_counted_under_its_name():
    host = Host()
    for seq, t in ((0, 0.0), (1, 0.1), (4, 0.4), (3, 0.3), (3, 0.3)):
        host.hear(seq, t)
    host.hear(5, 0.5, src=0x20)
    host.hear(6, 0.6)
    host.hear(7, 0.7, lqi=104)
    assert host.counted == {
        'lost_messages': 2,
        'reordered': 1,
        'duplicates': 1,
        'address_changes': 2,
        'address_conflicts': 1,
        'lqi_unreachable': 1,
    }
    assert host.intake.counters.keys() == set(COUNTERS)


@pytest.mark.parametrize(
    'event', [SysResetInd(2, 2, 0, 2, 6, 3), LinkEvent('opened', '/dev/pts/1'), LinkEvent('restarted')]
)
def test_clock_begins_anew_with_the_sink(event):
    host = Host()
    host.hear(1, 0.0)
    host.hear(2, 100.0)
    host.intake.take(Received(event, 1105 * S))
    after = host.hear(3, 110.0, 0.004, ticks_from=105.0)
    assert after.time_ns == int(1110.004 * S)
    assert host.counted == {}


def test_reset_that_nobody_announced_is_counted():
    host = Host()
    host.hear(1, 100.0)
    for k in range(4):
        host.hear(2 + k, 120.0 + k, ticks_from=119.0)
    assert host.counted == {'clock_strange': 2, 'clock_restarts': 1}


def test_record_was_measured_its_age_before():
    taken = Host().hear()
    assert taken.measured_ns(7) == taken.time_ns - 7 * MS
    assert taken.measured_ns(None) is None


def test_synchronised_nodes_give_the_time_themselves():
    """The second message needed 300 ms through the network: it left when its clock says."""
    host = Host()
    flags = int(Flag.CLOCK_SYNCHRONISED)
    first = host.hear(1, 10.0, flags=flags)
    payload = report_payload(node=4, seq=1, t_ms=10_500, flags=flags)
    late = host.intake.take(Received(Report(payload, 0x20, 105, 2, int(10.8 / 320e-6), 0x10), int(1010.802 * S)))
    assert abs(late.time_ns - first.time_ns - S // 2) < MS


def test_sink_without_a_clock_gives_the_arrival():
    host = Host()
    taken = host.intake.take(Received(Report(report_payload()), 5 * S))
    assert taken.time_ns == 5 * S


def test_what_is_no_report_means_nothing():
    assert Host().intake.take(Received(LinkEvent('up'), 0)) is None

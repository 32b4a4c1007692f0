from zstack_cases import report_payload

from wsn_tracking.zstack.duplicates import Verdict
from wsn_tracking.zstack.nodes import STREAMS, Nodes
from wsn_tracking.zstack.payload import Flag
from wsn_tracking.zstack.reports import Report

S = 1_000_000_000


def report(seq, node=3, src=0x10, t_ms=None, **more):
    return Report(report_payload(node, seq, 10**6 + 100 * seq if t_ms is None else t_ms, **more), src)


def judge(nodes, seq, at=None, **more):
    return nodes.judge(report(seq, **more), int((1000 + 0.1 * seq if at is None else at) * S))


def test_nodes_are_apart():
    nodes = Nodes()
    assert [judge(nodes, 5, node=node).verdict for node in (1, 2, 1, 2)] == [Verdict.NEW] * 2 + [Verdict.DUPLICATE] * 2


def test_report_without_a_number_is_always_new():
    nodes = Nodes()
    nameless = Report(report_payload(seq=None, t_ms=None))
    assert [nodes.judge(nameless, 0).verdict for _ in range(3)] == [Verdict.NEW] * 3


def test_number_without_a_time_is_judged_by_itself():
    nodes = Nodes()
    verdicts = [nodes.judge(Report(report_payload(seq=seq, t_ms=None)), S).verdict for seq in (1, 2, 2, 4, 3)]
    assert verdicts == [Verdict.NEW, Verdict.NEW, Verdict.DUPLICATE, Verdict.NEW, Verdict.REORDERED]


def test_robots_of_one_number_are_not_duplicates_where_each_has_a_line():
    nodes = Nodes()
    lines = [Report(report_payload(robot=robot), per_robot=True) for robot in (1, 2, 1)]
    assert [nodes.judge(line, 0).verdict for line in lines] == [Verdict.NEW, Verdict.NEW, Verdict.DUPLICATE]


def test_rejoin_under_another_address_goes_on():
    nodes = Nodes()
    for seq in range(10):
        judge(nodes, seq)
    moved = judge(nodes, 12, src=0x20)
    assert (moved.verdict, moved.lost, moved.moved, moved.conflict) == (Verdict.NEW, 2, True, False)
    assert judge(nodes, 12, src=0x20).verdict is Verdict.DUPLICATE
    assert judge(nodes, 9, src=0x20).verdict is Verdict.DUPLICATE  # repeated from before
    assert not judge(nodes, 13, src=0x20).moved


def test_rejoin_after_a_restart_is_accepted():
    nodes = Nodes()
    for seq in range(500):
        judge(nodes, seq)
    verdicts = [judge(nodes, seq, 1060 + seq, src=0x20, t_ms=100 * seq).verdict for seq in range(20)]
    assert verdicts == [Verdict.RESTARTED] + [Verdict.NEW] * 19


def test_two_radios_with_one_id_are_told_and_both_accepted():
    nodes, conflicts, lost = Nodes(), 0, 0
    for k in range(100):
        for src, seq, t_ms in ((0x10, k, 10**6 + 100 * k), (0x20, 30_000 + k, 5 * 10**6 + 100 * k)):
            judged = judge(nodes, seq, 1000 + 0.1 * k, src=src, t_ms=t_ms)
            assert judged.verdict in {Verdict.NEW, Verdict.RESTARTED}
            assert (judged.verdict is Verdict.RESTARTED) == (k == 0 and src == 0x20)
            conflicts += judged.conflict
            lost += judged.lost
            again = judge(nodes, seq, 1000 + 0.1 * k, src=src, t_ms=t_ms)
            assert again.verdict is Verdict.DUPLICATE
    assert conflicts == 198
    assert lost == 0


def test_application_retry_is_a_duplicate():
    nodes = Nodes()
    judge(nodes, 5)
    assert judge(nodes, 5, t_ms=10**6 + 900, flags=int(Flag.RETRY)).verdict is Verdict.DUPLICATE


def test_memory_is_bounded():
    nodes = Nodes()
    for node in range(STREAMS + 100):
        judge(nodes, 1, node=node)
    assert len(nodes._stations) == STREAMS
    for src in range(50):
        judge(nodes, 2 + src, node=STREAMS, src=src)
    assert len(nodes._stations[STREAMS, -1]) == 4

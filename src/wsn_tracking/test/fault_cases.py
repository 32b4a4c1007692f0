"""A host of this project behind a simulated sink with faults: what it hears of a world, and what is new of it."""

from sink_cases import Host, epochs, expected

from wsn_tracking.zstack.clock import ClockConfig
from wsn_tracking.zstack.intake import Intake
from wsn_tracking.zstack.lqi import SCALES
from wsn_tracking.zstack.queues import Received

WORLD = epochs(30, nodes=6)
ALL = expected(WORLD)


def ran(*faults, world=None, **config):
    """A host that has heard a whole world through a sink with these faults."""
    return Host(WORLD if world is None else world, faults=faults, **config).run()


def judged(host):
    """Counters of the intake, and the measurements that are new."""
    intake = Intake(ClockConfig(), SCALES['cc2530'])
    received = [Received(item, round(t * 1e9)) for item, t in zip(host.items, host.times, strict=True)]
    new = [t.report.payload for t in map(intake.take, received) if t is not None and t.is_new]
    heard = sorted((p.node_id, r.beacon_seq, r.rssi_dbm) for p in new for r in p.records)
    return {name: n for name, n in intake.counters.items() if n}, heard


def strikes(host):
    """How often faults have struck."""
    return sum(fault.strikes for fault in host.simulator.faults)


def writes(host):
    """What was written to the line, write by write."""
    return [action for _, action in host.actions if isinstance(action, bytes)]

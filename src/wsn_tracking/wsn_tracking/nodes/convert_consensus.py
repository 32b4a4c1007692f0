"""ConsensusReport message <-> value; a message that cannot be a value raises TrackingError."""

from __future__ import annotations

from wsn_tracking_msgs import msg

from wsn_tracking.errors import TrackingError
from wsn_tracking.nodes.convert import header, stamp_ns
from wsn_tracking.trackers.consensus_report import ConsensusReport


def report_value(m: msg.ConsensusReport) -> ConsensusReport:
    """The value of a ConsensusReport."""
    nodes = [m.node_ids, m.arrival_probabilities, m.disagreements, m.live, m.components]
    links = [m.link_senders, m.link_receivers]
    if len({len(column) for column in nodes}) > 1 or len(links[0]) != len(links[1]):
        raise TrackingError(
            f'a ConsensusReport has arrays of {[len(column) for column in nodes]} for its nodes and of '
            f'{[len(column) for column in links]} for its links: expected the same length for each'
        )
    columns = (tuple(column.tolist()) for column in (*nodes, *links))
    return ConsensusReport(stamp_ns(m.header.stamp), m.target_id, m.request_seq, *columns)


def report_message(r: ConsensusReport) -> msg.ConsensusReport:
    """The message of a ConsensusReport."""
    fields = r._asdict()
    return msg.ConsensusReport(header=header(fields.pop('stamp_ns')), **fields)

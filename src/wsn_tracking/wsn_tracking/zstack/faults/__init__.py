"""What goes wrong with real sinks, each as a small strategy that can be switched on, seeded (zstack.md, section 7)."""

from wsn_tracking.zstack.faults.base import Event, Fault, Happening, Write, struck_replies
from wsn_tracking.zstack.faults.table import FAULTS, parse_faults

__all__ = ['FAULTS', 'Event', 'Fault', 'Happening', 'Write', 'parse_faults', 'struck_replies']

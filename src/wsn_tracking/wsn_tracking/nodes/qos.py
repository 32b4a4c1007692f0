"""Quality of service, in one place (docs: `Topics and messages`)."""

from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

# A reader that pauses for a second must lose nothing: depth is memory for that, not a wish for delay.
MEASUREMENTS = QoSProfile(depth=1000, reliability=ReliabilityPolicy.RELIABLE)
# Between a feed and those that it does not wait for, who score and record; a gap between epochs may hold many poses.
FED = QoSProfile(depth=20000, reliability=ReliabilityPolicy.RELIABLE)
ESTIMATES = QoSProfile(depth=200, reliability=ReliabilityPolicy.RELIABLE)
LATCHED = QoSProfile(depth=1000, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL)
LATCHED_LAST = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL)
CLOCK = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
# Who only looks on takes and gives without acknowledgements: whatever it misses, nobody waits for it.
DISPLAY = QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT)

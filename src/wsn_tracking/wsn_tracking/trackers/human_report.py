"""What the particle filter of system C knows beside its estimates, for those who look on."""

from __future__ import annotations

from typing import NamedTuple


class HumanReport(NamedTuple):
    """HumanReport.msg, field by field."""

    stamp_ns: int
    target_id: int
    request_seq: int
    heading: float  # [rad] mean direction of the chest
    heading_known: float  # 0: any direction, 1: this one
    speed: float  # [m/s]
    particles: int
    n_eff: float
    log_evidence: float
    node_ids: tuple[int, ...]  # that were heard
    node_log_evidences: tuple[float, ...]
    reset: bool
    resets: int

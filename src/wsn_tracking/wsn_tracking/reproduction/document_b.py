"""Seed 002: consensus of cubature information filters whose observations come and go."""

from __future__ import annotations

from wsn_tracking.reproduction import b_consensus, b_faults, b_layouts, b_schemes

CLAIMS = (*b_consensus.CLAIMS, *b_layouts.CLAIMS, *b_schemes.CLAIMS, *b_faults.CLAIMS)

"""Seed 002: consensus of cubature information filters whose observations come and go."""

from __future__ import annotations

from wsn_tracking.reproduction import b_beyond, b_field

CLAIMS = (*b_field.CLAIMS, *b_beyond.CLAIMS)

"""Seed 001: least squares and extended Kalman filter combined, several targets in cells."""

from __future__ import annotations

from wsn_tracking.reproduction import d_beyond, d_phase, d_stops

CLAIMS = (*d_stops.CLAIMS, *d_phase.CLAIMS, *d_beyond.CLAIMS)

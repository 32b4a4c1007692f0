"""Seed 001: least squares and Kalman filter combined."""

from __future__ import annotations

from wsn_tracking.reproduction import d_stops

CLAIMS = d_stops.CLAIMS

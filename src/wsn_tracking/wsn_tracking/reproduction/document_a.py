"""Seed 000: event-triggered sensing, cubature filters with random process noise, covariance intersection."""

from __future__ import annotations

from wsn_tracking.reproduction import a_beyond, a_circle, a_fusion, a_loop, a_table

CLAIMS = (*a_circle.CLAIMS, *a_table.CLAIMS, *a_fusion.CLAIMS, *a_loop.CLAIMS, *a_beyond.CLAIMS)

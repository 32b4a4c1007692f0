"""Seed 003: a particle filter for a person whose body shadows the radio."""

from __future__ import annotations

from wsn_tracking.reproduction import c_channel, c_corridor, c_profiles, c_sweeps, c_trouble, c_walks

CLAIMS = (
    *c_walks.CLAIMS,
    *c_sweeps.CLAIMS,
    *c_corridor.CLAIMS,
    *c_channel.CLAIMS,
    *c_profiles.CLAIMS,
    *c_trouble.CLAIMS,
)

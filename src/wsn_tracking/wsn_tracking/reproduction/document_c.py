"""Seed 003: a particle filter for a person whose body shadows the radio."""

from __future__ import annotations

from wsn_tracking.reproduction import c_beyond, c_channel, c_people

CLAIMS = (*c_people.CLAIMS, *c_channel.CLAIMS, *c_beyond.CLAIMS)

"""Seed 004: a turning target by signal strengths that get lost. Of its results only the abstract survives."""

from __future__ import annotations

from wsn_tracking.reproduction import e_beyond, e_losses

CLAIMS = (*e_losses.CLAIMS, *e_beyond.CLAIMS)

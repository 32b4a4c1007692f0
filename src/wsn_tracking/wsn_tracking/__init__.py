"""Locate moving targets from the signal strengths and ranges of a wireless sensor network."""

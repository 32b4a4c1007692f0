"""Fusion of estimates whose correlation is unknown."""

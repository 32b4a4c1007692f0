"""Judges estimates and bags: runs the trackers on a bag, metrics, consistency, tables, plots, JSON."""

"""Metrics, consistency, tables and plots."""

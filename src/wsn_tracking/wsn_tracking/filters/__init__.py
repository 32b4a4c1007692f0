"""Recursive Bayesian filters in square-root form."""

"""Recordings: read, write, import of public data sets."""

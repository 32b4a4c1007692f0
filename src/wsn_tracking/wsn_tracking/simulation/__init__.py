"""Worlds and scenarios of the documents."""

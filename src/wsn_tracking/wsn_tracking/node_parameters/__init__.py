"""Parameters of every executable; a node imports those of its own kind alone, so that it starts quickly."""

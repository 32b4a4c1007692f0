"""Sizes of a benchmark that takes no time."""

from wsn_tracking.benchmarks.rows import Sizes

TINY = Sizes(rounds=1, least=0.0, batches=(3,), messages=120, bag_s=2.0, long_s=20.0, graph_s=0.5)

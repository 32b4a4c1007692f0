"""The long runs behind the figures of the docs: each system by many runs, the real graph, real radio."""

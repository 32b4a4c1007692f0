"""Public recordings into bags, one module a set; docs/datasets.md says where each comes from."""

KINDS = ('danis', 'kolakowski', 'lias', 'plaza', 'labyrinth', 'mrclam', 'zignav')

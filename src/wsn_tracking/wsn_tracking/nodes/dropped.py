"""What of the input was not used, from what all nodes of a graph tell of themselves."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping

PREFIX = 'dropped.'
# for these a message is dropped by every process that takes it
ANYWHERE = frozenset(
    {'other_anchors', 'unknown_node', 'other_target', 'late_request', 'duplicate_request', 'stray_request'}
)


def dropped_input(told: Iterable[Mapping[str, str]], *, several_targets: bool = False) -> dict[str, int]:
    """Counts by reason, of the values that each node has told last.

    Every system takes the whole input, so the one that dropped most for a reason tells; what the feed dropped comes on
    top. Within a system counts add up, but what is wrong for whoever takes it counts once, and so does what estimators
    that hear the same nodes (`hears`) have dropped.
    """
    alike: dict[tuple[str, str], Counter[str]] = {}
    for number, values in enumerate(told):
        counts = {name[len(PREFIX) :]: n for name, n in values.items() if name.startswith(PREFIX)}
        dropped = Counter({reason: int(n) for reason, n in counts.items() if n.isdecimal()})
        key = values.get('system', ''), values.get('hears', f'process {number}')
        alike[key] = alike.get(key, Counter()) | dropped
    systems: dict[str, Counter[str]] = {}
    for (system, _), dropped in alike.items():
        before = systems.get(system, Counter())
        once = Counter({reason: max(before[reason], dropped[reason]) for reason in ANYWHERE})
        systems[system] = Counter({**(before + dropped), **once})
    total = systems.pop('', Counter())
    worst: Counter[str] = Counter()
    for dropped in systems.values():
        worst |= dropped
    total = total + worst
    if several_targets:
        del total['other_target']  # another system follows it
    return {reason: n for reason, n in total.items() if n}

"""What the figures of a claim amount to. Nothing else decides: the report shows what these functions say of its JSON.

An interval inside its bounds holds, one outside fails, one across is open. Of a claim of a document

- `reproduced`: every rule holds
- `in shape`: all rules on the shape hold, the document's numbers are not met (or it has none that could be)
- `not reproduced`: a rule on the shape fails
- `undecided`: more runs would be needed
- `not reproducible`: what is needed is not in the document; the claim says what

A claim of this project (`beyond`) `holds`, `does not hold`, or is `undecided`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

Json = Mapping[str, Any]

REPRODUCED, IN_SHAPE, NOT_REPRODUCED = 'reproduced', 'in shape', 'not reproduced'
UNDECIDED, NOT_REPRODUCIBLE = 'undecided', 'not reproducible'
HOLDS, DOES_NOT_HOLD = 'holds', 'does not hold'


def judged(interval: Sequence[float | None] | None, bounds: Sequence[float | None]) -> str:
    """`holds`, `fails` or `open`. What is not a number fails: a filter that diverges proves nothing."""
    if interval is None or any(end is None or not math.isfinite(end) for end in interval):
        return 'fails'
    low, high = (float(end) for end in interval if end is not None)
    lowest = -math.inf if bounds[0] is None else bounds[0]
    highest = math.inf if bounds[1] is None else bounds[1]
    if lowest <= low and high <= highest:
        return 'holds'
    return 'fails' if high < lowest or low > highest else 'open'


def rules(claim: Json, kind: str) -> list[str]:
    """What becomes of every rule of a kind (`shape` or `near`) of a claim."""
    return [judged(f['interval_95'], f[kind]) for f in claim['figures'] if f.get(kind) is not None]


def verdict(claim: Json) -> str:
    """What a claim of the JSON amounts to."""
    shape, near = rules(claim, 'shape'), rules(claim, 'near')
    if claim['kind'] == 'beyond':
        if 'fails' in shape:
            return DOES_NOT_HOLD
        return UNDECIDED if 'open' in shape or not shape else HOLDS
    if claim['impossible']:
        return NOT_REPRODUCIBLE
    if 'fails' in shape:
        return NOT_REPRODUCED
    if 'open' in shape or not shape + near:
        return UNDECIDED
    if claim['in_kind'] or 'fails' in near:
        return IN_SHAPE
    return UNDECIDED if 'open' in near else REPRODUCED


def verdicts(content: Json) -> dict[str, str]:
    """The verdict of every claim of a reproduction's JSON, by id."""
    return {claim['id']: verdict(claim) for claim in content['claims']}

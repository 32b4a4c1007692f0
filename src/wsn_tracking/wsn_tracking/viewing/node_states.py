"""How a node is shown that sent in an epoch, or that stayed silent, by its reason."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from wsn_tracking.sensing.values import Reason

SENT = 0  # beside the reasons of silence, which begin at 1
ARRIVED, LOST = -1, -2  # of a node of system B: whether it takes what it read for an observation


class Look(NamedTuple):
    """Colour (#rrggbb) and what it means."""

    color: str
    words: str


# Green is what was sent; sky blue, vermilion and purple were heard well and not needed; the paler, the less was heard.
LOOKS: Mapping[int, Look] = {
    SENT: Look('#009e73', 'sent'),
    Reason.UNCHANGED: Look('#56b4e9', 'unchanged'),
    Reason.NOISY: Look('#d55e00', 'noisy'),
    Reason.NOT_DRAWN: Look('#cc79a7', 'not drawn'),
    Reason.OUT_OF_RADIUS: Look('#8c8c8c', 'out of radius'),
    Reason.NOT_HEARD: Look('#d0d0d0', 'not heard'),
    Reason.INVALID: Look('#e69f00', 'invalid'),
    Reason.ON_BOARD: Look('#f0e442', 'silent (decided on board)'),
    ARRIVED: Look('#117733', 'observation arrived'),
    LOST: Look('#882255', 'observation lost'),
}
UNREPORTED = Look('#ffffff', 'no report')


def look(state: int | None) -> Look:
    """The look of SENT, of a Reason, of ARRIVED or LOST, or of a node that nothing is known of."""
    if state is None:
        return UNREPORTED
    return LOOKS.get(state, Look('#000000', f'reason {state}'))


def rgb(color: str) -> tuple[float, float, float]:
    """'#rrggbb' as red, green, blue in 0..1."""
    return int(color[1:3], 16) / 255.0, int(color[3:5], 16) / 255.0, int(color[5:7], 16) / 255.0

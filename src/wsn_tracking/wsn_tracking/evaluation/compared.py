"""What the rules that a run is compared with make of local estimates that came one by one."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

from wsn_tracking.sensing.runs import JUMP_NS
from wsn_tracking.trackers.estimate import Estimate
from wsn_tracking.trackers.fusing import Fuser

Key = tuple[int, int, int]  # stamp, request_seq, and how often they came before: a looped bag repeats both


def fused_by(fuser: Fuser, locals_: Sequence[Sequence[Estimate]]) -> list[Estimate]:
    """What a fuser makes of the epochs of which every estimator told its local estimate, from a start of its own.

    locals_: of each estimator, in the order of its epochs. Where time falls back, the fuser starts anew, as in `run`.
    """
    held = [_by_epoch(estimates) for estimates in locals_]
    fuser.reset()
    fused: list[Estimate] = []
    for key in held[0] if held else ():
        if not all(key in others for others in held):
            continue
        if fused and key[0] < fused[-1].stamp_ns - JUMP_NS:
            fuser.reset()
        fused.append(fuser.step([others[key] for others in held]))
    return fused


def _by_epoch(estimates: Iterable[Estimate]) -> dict[Key, Estimate]:
    seen: Counter[tuple[int, int]] = Counter()
    held: dict[Key, Estimate] = {}
    for e in estimates:
        epoch = (e.stamp_ns, e.request_seq)
        held[(*epoch, seen[epoch])] = e
        seen[epoch] += 1
    return held

"""Who measures while several targets are tracked, told over the network (the base station of seed 001, live)."""

from __future__ import annotations

from wsn_tracking.models.anchors import Floats
from wsn_tracking.sensing.scheduler import CellScheduler, Command

AGAIN_NS = 5_000_000_000  # all nodes are told anew so often: a command may be lost, and a node may have restarted
GONE_NS = 5_000_000_000  # a target of which there was no epoch for so long keeps nobody awake


class Schedule:
    """The cells round the predictions of all targets; every node while one of them is still looked for."""

    def __init__(self, scheduler: CellScheduler) -> None:
        self._scheduler = scheduler
        self._cells: dict[int, int | None] = {}  # of each target; None: it is looked for
        self._seen: dict[int, int] = {}  # target -> stamp of its last epoch [ns]
        self._told: set[int] | None = None  # the cells that measure, as the nodes know
        self._all_told_ns = 0

    def see(self, target_id: int, stamp_ns: int, prediction: Floats | None) -> tuple[Command, ...]:
        """Where a target will be (2,) [m] after its epoch, None: nobody knows; whom to tell what."""
        before = self._cells.get(target_id)
        self._cells[target_id] = None if prediction is None else int(self._scheduler.cell(prediction[:2], before))
        self._seen[target_id] = stamp_ns
        for gone in [target for target, seen in self._seen.items() if abs(stamp_ns - seen) > GONE_NS]:
            del self._seen[gone], self._cells[gone]
        wanted = {cell for cell in self._cells.values() if cell is not None}
        if None in self._cells.values():
            wanted = set(range(len(self._scheduler.corners)))
        if abs(stamp_ns - self._all_told_ns) > AGAIN_NS:
            self._told, self._all_told_ns = None, stamp_ns
        commands = self._scheduler.commands(wanted, self._told)
        self._told = wanted
        return commands

"""The three pictures of an evaluation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from wsn_tracking.evaluation.plot_map import Area, plot_map
from wsn_tracking.evaluation.plot_series import plot_errors, plot_nees
from wsn_tracking.evaluation.score import SKIP_S
from wsn_tracking.models.anchors import Anchors
from wsn_tracking.sensing.recording import Truth
from wsn_tracking.trackers.estimate import Estimate


def plot_all(
    directory: str | Path,
    anchors: Anchors,
    truths: Mapping[int, Truth],
    estimates: Mapping[str, Sequence[Estimate]],
    area: Area | None = None,
    *,
    title: str = '',
    start_ns: int | None = None,
    skip_s: float = SKIP_S,
) -> list[Path]:
    """Write map.png, and where the truth of a target is known error.png and nees.png; the paths that were written."""
    folder = Path(directory)
    lead = f'{title}: ' if title else ''
    written = [folder / 'map.png']
    plot_map(written[0], anchors, truths, estimates, area, title=f'{lead}truth and estimates')
    judged = {name: e for name, e in estimates.items() if e and e[0].target_id in truths}
    if truths:
        written += [folder / 'error.png', folder / 'nees.png']
        plot_errors(written[1], truths, judged, title=f'{lead}position error', start_ns=start_ns, skip_s=skip_s)
        plot_nees(
            written[2],
            truths,
            judged,
            title=f'{lead}NEES of the position',
            start_ns=start_ns,
            skip_s=skip_s,
        )
    return written

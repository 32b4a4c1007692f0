"""How well a robot keeps in phase with another one by feedback over the network (seed 001, its second experiment)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from wsn_tracking.simulation.d_cells import CellsConfig
from wsn_tracking.studies.intervals import short
from wsn_tracking.studies.phase_runs import SETTLED_S, PhaseConfig, PhaseRun, run
from wsn_tracking.studies.results import Result

CAUGHT_UP = np.radians(10.0)


def variants(lasts: float = 60.0) -> Mapping[str, PhaseConfig]:
    """The loop as it is by default, and what is worse or better of it."""
    base = PhaseConfig(cells=CellsConfig(lasts=lasts))
    return {
        'default': base,
        'constant_angular_speed': replace(base, cells=replace(base.cells, variation=0.0)),
        'truth_fed_back': replace(base, told='truth'),
        'feedback_at_2_hz': replace(base, every=10),
        'feedback_200_ms_late': replace(base, delay=0.2),
        'half_of_the_feedback_lost': replace(base, loss=0.5),
        'a_third_of_the_ranges_lost': replace(base, cells=replace(base.cells, dropout=0.3)),
    }


def phase(runs: int = 5, lasts: float = 60.0, settled: float = SETTLED_S) -> Result:
    """Error in phase of the second robot of d_phase, driven by feedback, once it has caught up a third of a turn."""
    table = {}
    for name, config in variants(lasts).items():
        found = [run(config, seed) for seed in range(1, runs + 1)]
        table[name] = summary(found, settled)
    return {'runs': runs, 'lasts_s': lasts, 'scored_from_s': settled, 'variants': table}


def summary(runs: list[PhaseRun], settled: float) -> Result:
    """Of several runs of one configuration, from `settled` [s] on."""
    scored = runs[0].times >= settled
    error = np.degrees(np.stack([r.error for r in runs]))
    squared = [np.nanmean(np.sum((r.estimates - r.truth[..., :2])[:, scored] ** 2, axis=-1)) for r in runs]
    return {
        'rms_deg': short(np.sqrt(np.mean(error[:, scored] ** 2)), 3),
        'worst_deg': short(np.abs(error[:, scored]).max(), 3),
        'caught_up_after_s': short(max(caught_up(r) for r in runs), 3),
        'tracking_rmse_cm': short(100.0 * np.sqrt(np.mean(squared)), 3),
    }


def caught_up(r: PhaseRun) -> float:
    """When the second robot was last more than 10 degrees off [s]."""
    off = np.flatnonzero(np.abs(r.error) > CAUGHT_UP)
    return float(r.times[off[-1]]) if off.size else 0.0

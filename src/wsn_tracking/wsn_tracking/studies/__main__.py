"""The studies by many runs, by name; their figures are kept under docs/results.

    python -m wsn_tracking.studies -o docs/results [NAME ...]

Studies that are run in another way have commands of their own: `consensus`, `live` and `serial` beside this module,
and `real_radio`, which needs recordings.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence

from wsn_tracking.studies import (
    human,
    human_parts,
    hybrid,
    loss,
    phase,
    random_q,
    random_q_noise,
    random_q_triggers,
    random_q_whole_db,
)
from wsn_tracking.studies.results import Studies, call

STUDIES: Studies = {
    'system_a': {
        'trigger_rate': random_q.trigger_rate,
        'update_forms': random_q.update_forms,
        'matched_model': random_q.matched_model,
        'process_noise': random_q_noise.process_noise,
        'fusion_rules': random_q_noise.fusion_rules,
        'data_rate': random_q_triggers.data_rate,
    },
    'whole_db': {'whole_db': random_q_whole_db.whole_db},
    'human': {
        'profiles': human.profiles,
        'circle': human.circle,
        'corridor': human.corridor,
        'spacing': human.spacing,
        'noise': human.noise,
        'parts': human_parts.parts,
        'teleport': human_parts.teleport,
        'needless': human_parts.needless,
        'silence': human_parts.silence,
        'disc_lag': human_parts.disc_lag,
    },
    'loss_tolerant': {
        'loss_rate': loss.loss_rate,
        'loss_kind': loss.loss_kind,
    },
    'hybrid': {
        'sudden_stop': hybrid.sudden_stop,
        'lost_ranges': hybrid.lost_ranges,
        'gate': hybrid.gate,
        'frozen_gain': hybrid.frozen_gain,
    },
    'follower': {'phase': phase.phase},
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Entry point; the exit status."""
    return call('wsn_tracking.studies', 'Run the studies by many runs.', STUDIES, arguments)


if __name__ == '__main__':
    sys.exit(main())

"""Plans and graphs of short recordings, and what is refused."""

from __future__ import annotations

import pytest
from graph_cases import a_loop, ranged, with_second_target, without_truth

from wsn_tracking.errors import TrackingError
from wsn_tracking.graphs import How, Process, complete, plans_of, source_of
from wsn_tracking.sensing.stage import TriggerConfig

FEED = Process('bag_player_node', 'bag_player', {'bag': 'x', 'rate': 0.0})
BAGS = {
    'rssi': a_loop(3),
    'range': ranged(a_loop(3), TriggerConfig(kind='near')),
    'range_without_reports': ranged(a_loop(3), TriggerConfig(kind='near'), reports=False),
    'no_truth': without_truth(a_loop(3)),
    'two_targets': with_second_target(a_loop(3)),
}


def source(recording=None, **metadata):
    """Where a graph gets its messages from; `metadata` are added to those of the bag."""
    s = source_of('some_bag', recording or a_loop(3))
    return s._replace(metadata={**s.metadata, **metadata})


def planned(s, configuration='', settings=None, target_id=-1):
    """The plan of system A."""
    (plan,) = plans_of(s, a_loop(3).anchors, 'random_q', configuration, settings, target_id)
    return plan


def graph(s, plan=None, settings=None, one_process_each=False, **options):
    """The processes of a replay by that plan."""
    how = How(replay=True, settings=settings or {}, one_process_each=one_process_each)
    return complete(s, [plan or planned(s)], FEED, how, **options)


def by_name(processes):
    """Processes by their names."""
    return {p.name: p for p in processes}


def refusal(*args, **kwargs):
    """The words in which a plan is refused."""
    with pytest.raises(TrackingError) as error:
        planned(*args, **kwargs)
    return str(error.value)

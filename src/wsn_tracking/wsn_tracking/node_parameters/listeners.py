"""Parameters of what listens to a graph: bag_recorder_node, evaluator_node and marker_node."""

from __future__ import annotations

from dataclasses import dataclass

from wsn_tracking.parameters import group, param
from wsn_tracking.trackers.fusing import FusionConfig


@dataclass(frozen=True)
class RecorderConfig:
    """bag_recorder_node."""

    output: str = param('recording', 'folder to write; it must not exist')
    entry_level: str = param(
        'rssi', 'the one level of measurements that is recorded', choices=('rssi', 'range', 'observation')
    )
    targets: tuple[int, ...] = param((1,), 'targets whose truth is recorded', 'id', 0, 65535)
    extra_topics: tuple[str, ...] = param(('',), 'derived topics that are recorded as well, e.g. estimate/fused_1')
    metadata: tuple[str, ...] = param(('',), 'key=value entries for the metadata of the bag')
    silence: float = param(1.0, 'after the final epoch: silence that ends the recording', 's', 1e-2, 3600.0)
    loss_timeout: float = param(
        6.0, 'the same while what the feed has listed, or a last estimate, has not come', 's', 1e-2, 3600.0
    )


@dataclass(frozen=True)
class EvaluatorConfig:
    """evaluator_node."""

    outputs: tuple[str, ...] = param(
        ('local_1', 'local_2', 'local_3', 'fused_1', 'fused_2', 'fused_3'), 'estimates that are scored'
    )
    targets: tuple[int, ...] = param((1,), 'targets whose estimates are scored', 'id', 0, 65535)
    title: str = param('live', 'heading of the table')
    skip: float = param(5.0, 'errors before this time after the first epoch are not scored', 's', 0.0, 1e9)
    json: str = param('', 'file that the scores are written to; empty: none')
    plot: str = param('', 'folder that the plots are drawn in; empty: none')
    expected_reports: tuple[str, ...] = param(('',), 'nodes whose final counts go into the table')
    output_timeout: float = param(5.0, 'after the final epoch: an output silent for so long is given up', 's', 1e-2)
    fusion: FusionConfig = group(FusionConfig)


@dataclass(frozen=True)
class MarkerConfig:
    """marker_node."""

    outputs: tuple[str, ...] = param(('',), 'estimates that are drawn; empty: all that are published')
    track_length: int = param(200, 'epochs of a track that are drawn', '', 2, 100000)
    redraw_rate: float = param(5.0, 'at most so many arrays of markers a second', 'Hz', 0.01, 100.0)
    marker_size: float = param(0.0, 'diameter of a node; 0: from the extent of all of them', 'm', 0.0, 1000.0)
    target_height: float = param(0.0, 'height at which estimates are drawn', 'm', -1e4, 1e4)

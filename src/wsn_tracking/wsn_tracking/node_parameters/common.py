"""Parameters that many executables share."""

from __future__ import annotations

from dataclasses import dataclass

from wsn_tracking.parameters import param


@dataclass(frozen=True)
class NodeConfig:
    """Every node: when it says that it is ready, and when that its data has stopped."""

    expected_subscribers: tuple[str, ...] = param(
        ('',), 'for each output that others wait for, topic=count; set by launch files'
    )
    expected_publishers: tuple[str, ...] = param(('',), 'for each input, topic=count; set by launch files')
    silence_timeout: float = param(
        5.0, 'requests that stop for longer before the feed has ended are an error', 's', 1e-2
    )


@dataclass(frozen=True)
class AssemblyConfig:
    """How a node collects the messages of an epoch."""

    target_id: int = param(-1, 'the target that is tracked; -1: the first that is heard', 'id', -1, 65535)
    loss_timeout: float = param(1.0, 'steady time after which a listed message counts as lost', 's', 1e-3, 3600.0)
    lossless: bool = param(False, 'set in replay: a message that is missing is an error')

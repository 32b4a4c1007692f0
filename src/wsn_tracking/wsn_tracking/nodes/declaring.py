"""A configuration class as the parameters of a node."""

from __future__ import annotations

from typing import TypeVar

from rcl_interfaces.msg import ParameterDescriptor
from rclpy.node import Node
from rclpy.qos_overriding_options import QoSOverridingOptions

from wsn_tracking import parameters
from wsn_tracking.errors import TrackingError

Config = TypeVar('Config')

OVERRIDE = 'qos_overrides.'


def declare(node: Node, kind: type[Config]) -> Config:
    """The configuration of what the node was started with; every parameter is read-only and described."""
    values = {}
    for spec in parameters.specs(kind):
        descriptor = ParameterDescriptor(
            description=spec.why, additional_constraints=spec.expected, read_only=True, dynamic_typing=True
        )
        default = list(spec.default) if isinstance(spec.default, tuple) else spec.default
        value = node.declare_parameter(spec.name, default, descriptor).value
        values[spec.name] = spec.default if value is None else value  # a parameter file's [] comes as nothing
    return parameters.build(kind, values)


def warn_of_strangers(node: Node) -> None:
    """Say which of the parameters that the node was started with no node of this package has: they have no effect."""
    strangers = [name for name in _given(node) if not (node.has_parameter(name) or name.startswith(OVERRIDE))]
    if not strangers:
        return
    from wsn_tracking.configuration import check_known  # knows the parameters of all nodes; few starts need it

    for name in strangers:
        try:
            check_known(name, 'given at the start and ignored')
        except TrackingError as error:
            node.get_logger().warn(str(error))


def qos_overrides(node: Node) -> QoSOverridingOptions | None:
    """What `qos_overrides.<topic>...` may change, for a node that was started with any of them."""
    asked = any(name.startswith(OVERRIDE) for name in _given(node))
    return QoSOverridingOptions.with_default_policies() if asked else None


def _given(node: Node) -> list[str]:
    """The names of what the node was started with; rclpy keeps them without a public way to ask."""
    return list(getattr(node, '_parameter_overrides', {}))

"""Parameters as data: every tunable field carries its unit, range and reason, for YAML, ROS and the docs alike.

A configuration is a frozen dataclass whose fields are made by `param` or are configurations themselves;
the dotted names of the leaves (`trigger.alpha`) are the names in YAML and in `ros2 param`.
"""

from __future__ import annotations

import dataclasses
import math
import sys
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple, TypeVar, get_type_hints

from wsn_tracking.errors import TrackingError

Config = TypeVar('Config')
Values = Mapping[str, Any]  # dotted parameter name -> value


ELEMENTS = {int: 'integers', float: 'numbers', str: 'texts'}
MAX_INT = 2**63 - 1  # ROS parameters are of 64 bits
MAX_FLOAT = sys.float_info.max
MAX_SHOWN = 100  # characters of a refused value


class Spec(NamedTuple):
    """One parameter: default (whose type counts), reason, unit, and what it may be."""

    name: str
    default: Any
    why: str
    unit: str = ''
    low: float = -math.inf
    high: float = math.inf
    choices: tuple[str, ...] = ()

    @property
    def element(self) -> type:
        """Of what a list is made; an empty default does not show it, its unit does."""
        return type(self.default[0]) if self.default else (int if self.unit in ('', 'id') else float)

    @property
    def expected(self) -> str:
        """What a value must be, in words."""
        kind = {bool: 'true or false', int: 'an integer', float: 'a number', str: 'a text'}
        is_list = isinstance(self.default, tuple)
        words = f'a list of {ELEMENTS[self.element]}' if is_list else kind[type(self.default)]
        if self.choices:
            return 'one of ' + ', '.join(self.choices)
        limits = [f'>= {self.low:g}'] * (self.low > -math.inf) + [f'<= {self.high:g}'] * (self.high < math.inf)
        unit = f' [{self.unit}]' if self.unit else ''
        return ' '.join([words, ' and '.join(limits)]).strip() + unit


def param(
    default: Any,
    why: str,
    unit: str = '',
    low: float = -math.inf,
    high: float = math.inf,
    choices: tuple[str, ...] = (),
) -> Any:
    """A dataclass field with what `Spec` needs."""
    spec = {'why': why, 'unit': unit, 'low': low, 'high': high, 'choices': choices}
    return dataclasses.field(default=default, metadata=spec)


def group(kind: type[Config]) -> Config:
    """A dataclass field that is a configuration itself."""
    return dataclasses.field(default_factory=kind)


def specs(kind: type[Any], prefix: str = '') -> Iterator[Spec]:
    """The leaves of a configuration class, dotted."""
    hints = get_type_hints(kind)
    for field in dataclasses.fields(kind):
        name = prefix + field.name
        if dataclasses.is_dataclass(hints[field.name]):
            yield from specs(hints[field.name], name + '.')
        else:
            yield Spec(name, field.default, **field.metadata)


def build(kind: type[Config], values: Mapping[str, Any]) -> Config:
    """Make a configuration of dotted values; what is absent keeps its default, what is not its own is ignored."""
    checked = {spec.name: check(spec, values[spec.name]) for spec in specs(kind) if spec.name in values}
    return _assemble(kind, checked, '')


def _assemble(kind: type[Config], values: Mapping[str, Any], prefix: str) -> Config:
    hints = get_type_hints(kind)
    arguments: dict[str, Any] = {}
    for field in dataclasses.fields(kind):  # type: ignore[arg-type]
        name = prefix + field.name
        if dataclasses.is_dataclass(hints[field.name]):
            arguments[field.name] = _assemble(hints[field.name], values, name + '.')
        elif name in values:
            arguments[field.name] = values[name]
    return kind(**arguments)


def check(spec: Spec, value: Any) -> Any:
    """The value in the type of the default; TrackingError where it is not what is expected."""
    if isinstance(spec.default, tuple):
        wanted = spec.element
        items = value.tolist() if hasattr(value, 'tolist') else value  # array.array, as rclpy gives it
        if not isinstance(items, (list, tuple)):
            _refuse(spec, value)
        return tuple(_scalar(spec, wanted, item, value) for item in items)
    return _scalar(spec, type(spec.default), value, value)


def _scalar(spec: Spec, wanted: type, item: Any, seen: Any) -> Any:
    accepted = (int, float) if wanted is float else wanted
    if not isinstance(item, accepted) or (wanted is not bool and isinstance(item, bool)):
        _refuse(spec, seen)
    limit = MAX_INT if wanted is int else MAX_FLOAT
    if isinstance(item, (int, float)) and not (spec.low <= item <= spec.high and abs(item) <= limit):
        _refuse(spec, seen)
    item = float(item) if wanted is float else item
    if spec.choices and item not in spec.choices:
        _refuse(spec, seen)
    return item


def _refuse(spec: Spec, seen: Any) -> None:
    try:
        shown = repr(seen)
    except ValueError:  # Python does not write integers of more than 4300 digits
        shown = 'a huge number'
    shown = shown if len(shown) <= MAX_SHOWN else shown[:MAX_SHOWN] + '...'
    raise TrackingError(f'parameter `{spec.name}` is {shown}: expected {spec.expected} ({spec.why})')

"""The documents' experiments, by name."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any

from wsn_tracking.errors import TrackingError
from wsn_tracking.parameters import build, specs
from wsn_tracking.simulation.a_robot import a_circle, a_heading, a_loop
from wsn_tracking.simulation.b_field import FieldConfig, b_field
from wsn_tracking.simulation.c_body import BODY_SCENARIOS, BodyConfig, body_scenario
from wsn_tracking.simulation.d_cells import CellsConfig, DropoutConfig, d_arc_stop, d_dropout, d_phase, d_stop
from wsn_tracking.simulation.e_loss import LossConfig, e_loss
from wsn_tracking.simulation.scenario import Scenario


def _body(name: str, seed: int = 0, config: BodyConfig | None = None) -> Scenario:
    """One of seed 003."""
    return body_scenario(name, config or BODY_SCENARIOS[name](), seed)


SCENARIOS: Mapping[str, Callable[..., Scenario]] = {
    'a_loop': a_loop,
    'a_circle': a_circle,
    'a_heading': a_heading,
    'b_field': b_field,
    **{name: partial(_body, name) for name in BODY_SCENARIOS},
    'd_stop': d_stop,
    'd_arc_stop': d_arc_stop,
    'd_phase': d_phase,
    'd_dropout': d_dropout,
    'e_loss': e_loss,
}
BY_SEED = ('a_heading', *BODY_SCENARIOS)  # those whose walk is drawn by the seed of the recording
PARAMETERS: Mapping[str, type[Any]] = {  # of those that have any
    'b_field': FieldConfig,
    **BODY_SCENARIOS,
    'd_stop': CellsConfig,
    'd_arc_stop': CellsConfig,
    'd_phase': CellsConfig,
    'd_dropout': DropoutConfig,
    'e_loss': LossConfig,
}


def settings_of(entries: Iterable[str]) -> dict[str, Any]:
    """Parameters of a scenario from name=value each, values in YAML; empty entries say nothing."""
    from wsn_tracking.ros_yaml import parse  # where something is set

    settings = {}
    for entry in filter(None, entries):
        name, separator, value = entry.partition('=')
        if not separator:
            raise TrackingError(f'setting {entry!r}: expected name=value, e.g. faults=clutter')
        if name in settings:
            raise TrackingError(f'setting {entry!r}: `{name}` is set twice')
        settings[name] = parse(value, f'setting {entry!r}')
    return settings


def scenario(name: str, settings: Mapping[str, Any] | None = None, seed: int = 0) -> Scenario:
    """The scenario of that name, with its parameters as `settings` say; seed: of the recording that is to be made."""
    if name not in SCENARIOS:
        raise TrackingError(f'there is no scenario `{name}`: expected one of {", ".join(SCENARIOS)}')
    if not settings:
        return SCENARIOS[name](seed) if name in BY_SEED else SCENARIOS[name]()
    known = [spec.name for spec in specs(PARAMETERS[name])] if name in PARAMETERS else []
    if unknown := sorted(set(settings) - set(known)):
        raise TrackingError(
            f'scenario `{name}` has no parameter `{unknown[0]}`: expected one of {", ".join(known) or "(none)"}'
        )
    config = build(PARAMETERS[name], settings)
    return SCENARIOS[name](seed, config) if name in BY_SEED else SCENARIOS[name](config)

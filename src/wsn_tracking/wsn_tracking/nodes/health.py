"""When a node is well: the WARN and ERROR conditions of docs/diagnostics.md as pure functions."""

from __future__ import annotations

from collections.abc import Collection
from typing import NamedTuple

OK, WARN, ERROR = b'\x00', b'\x01', b'\x02'  # DiagnosticStatus.OK, WARN, ERROR


class Health(NamedTuple):
    """Level and one sentence."""

    level: bytes
    sentence: str


def worst(*conditions: Health) -> Health:
    """The first of those with the highest level."""
    return max(conditions, key=lambda health: health.level)


def flow(age: float | None, ended: bool, timeout: float) -> Health:
    """No request yet is no error; requests that stopped before the feed ended are. age [s] of the last one."""
    if age is None:
        return Health(OK, 'no data yet')
    if ended:
        return Health(OK, 'the feed has ended')
    if age > timeout:
        return Health(ERROR, f'no request for {age:.1f} s')
    return Health(OK, 'running')


def peers(absent: Collection[int]) -> Health:
    """A peer is absent after three epochs without its local estimate."""
    if absent:
        return Health(WARN, f'estimators {sorted(absent)} have been silent for 3 epochs')
    return Health(OK, '')


def neighbours(silent: Collection[int], epochs: int) -> Health:
    """A neighbour is not counted after `epochs` without a share."""
    if silent:
        return Health(WARN, f'neighbours {sorted(silent)} have been silent for {epochs} epochs')
    return Health(OK, '')


def outputs(given_up: Collection[str]) -> Health:
    """An output is given up after `output_timeout` of silence while epochs wait for it."""
    if given_up:
        return Health(WARN, f'silent outputs: {sorted(given_up)}')
    return Health(OK, '')


def truth(estimates: int, poses: int) -> Health:
    """Estimates without any truth cannot be scored."""
    if estimates and not poses:
        return Health(WARN, 'estimates come, but no truth')
    return Health(OK, '')


def link(up: bool, error: str, requests: Health) -> Health:
    """A link that is down is an error, with the reason; requests that stop on a link that is up are a warning."""
    if not up:
        return Health(ERROR, f'no sink: {error}' if error else 'the sink is being attached')
    if requests.level == ERROR:
        return Health(WARN, requests.sentence)
    return requests


def radio(conflicting: Collection[int], lqi: str) -> Health:
    """Nodes whose id two radios bear, and what is wrong with the scale of LQI; both mislead without any other sign."""
    wrong = [f'two radios bear the id of nodes {sorted(conflicting)}'] if conflicting else []
    wrong += [f'LQI: {lqi}'] if lqi else []
    return Health(WARN, '; '.join(wrong)) if wrong else Health(OK, '')

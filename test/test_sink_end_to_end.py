"""Twelve nodes on a serial line, through bridge and sensing to the estimators: nothing is lost."""

from __future__ import annotations

import live
from radio import LIVE
from wsn_tracking.studies import serial
from wsn_tracking.zstack.parser import MAX_HELD

EPOCHS = 20


def test_what_the_nodes_say_reaches_every_estimator(monkeypatch):
    """The study of `make study`, shorter, and with timeouts that no pause of a busy machine exceeds."""
    with live.private_domain() as environment:
        for name in ('ROS_DOMAIN_ID', 'ROS_AUTOMATIC_DISCOVERY_RANGE'):
            monkeypatch.setenv(name, environment[name])
        told = serial.end_to_end(EPOCHS / serial.HERTZ, LIVE)
    everything = 12 * EPOCHS
    assert (told['said'], told['arrived'], told['lost'], told['faults']) == (everything, everything, 0, {})
    outputs = [f'{kind}_{i}' for kind in ('fused', 'local') for i in (1, 2, 3)]
    assert told['estimates'] == dict.fromkeys(outputs, EPOCHS)
    assert told['measurements_used'] == dict.fromkeys(outputs, everything)
    assert told['fused_from_fewer_than_3'] == 0


def test_noise_of_the_study_holds_little_and_never_raises():
    told = serial.noise(100_000)
    assert told['bytes'] == 100_000
    assert told['most_held_bytes'] <= MAX_HELD

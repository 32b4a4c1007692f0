"""What serial_bridge_node says at its terminal."""

from __future__ import annotations

import os

from sink_cases import epochs

import live
from radio import LIVE, Radio, until
from wsn_tracking.graphs import Process
from wsn_tracking.node_parameters.serial import SerialBridgeConfig
from wsn_tracking.parameters import specs

QUICK = {name: LIVE[name] for name in sorted(LIVE.keys() & {spec.name for spec in specs(SerialBridgeConfig)})}


class Terminal:
    """What a process has said so far."""

    def __init__(self, process):
        self._source = process.stdout.fileno()
        os.set_blocking(self._source, False)
        self.said = ''

    def shows(self, words):
        try:
            self.said += os.read(self._source, 65536).decode()
        except BlockingIOError:
            return words in self.said
        return words in self.said


def test_it_says_once_why_there_is_no_sink_and_that_there_is_one(tmp_path):
    link = tmp_path / 'sink'
    bridge = Process('serial_bridge_node', 'bridge', {**QUICK, 'port': str(link)})
    with live.private_domain() as environment, live.started([bridge], environment) as running:
        terminal = Terminal(running['bridge'])
        until(lambda: terminal.shows(f'no such port: {link}'), 'the reason')
        radio = Radio(link, epochs(1))
        with radio.running():
            until(lambda: terminal.shows(f'the sink is at {radio.port.device}'), 'the sink')
    assert terminal.said.count('no such port') == 1

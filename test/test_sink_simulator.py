"""A simulated sink on a real pseudo terminal: its port, the faults that need one, the node, and the command line."""

from __future__ import annotations

import argparse
import contextlib
import os
import signal
import subprocess
import sys

import pytest
from nav_msgs.msg import Odometry
from sink_cases import epochs, expected
from std_msgs.msg import String
from wsn_tracking_msgs import msg

import live
from observer import observing
from radio import PATIENCE, until
from wsn_tracking.commands import sink_simulate
from wsn_tracking.errors import TrackingError
from wsn_tracking.nodes import convert, qos
from wsn_tracking.processes import executable
from wsn_tracking.zstack import commands as c
from wsn_tracking.zstack.port import open_port
from wsn_tracking.zstack.pty_port import PtyPort
from wsn_tracking.zstack.settings import FormConfig

WORLD = epochs(12, nodes=6)
RATE = 60.0
MARGIN_NS = 200_000_000  # what a busy machine may hold up every message of a run


@pytest.fixture
def sink(radio):
    """Starts sinks that tell of this world."""
    return lambda world=WORLD, **config: radio(world, **{'rate': RATE, **config})


# ---- the port


def test_link_stays_while_the_device_changes(link):
    port = PtyPort(link)
    port.plug()
    port.plug()
    first = port.device
    assert os.path.realpath(link) == first
    port.unplug(reserve=True)
    assert not link.is_symlink()
    port.plug()
    assert port.device != first
    assert os.path.realpath(link) == port.device
    port.unplug()
    assert not link.is_symlink()


def test_link_of_a_run_that_was_killed_is_replaced(link):
    link.symlink_to('/dev/pts/no_such')
    port = PtyPort(link)
    port.plug()
    assert os.path.realpath(link) == port.device
    port.unplug()


def test_link_that_another_sink_has_taken_over_is_left(link):
    one, other = PtyPort(link), PtyPort(link)
    one.plug()
    other.plug()
    one.unplug()
    assert os.path.realpath(link) == other.device
    other.unplug()


def test_files_are_not_replaced(link):
    link.write_text('precious')
    with pytest.raises(TrackingError, match='no symbolic link'):
        PtyPort(link).plug()
    assert link.read_text() == 'precious'
    with pytest.raises(TrackingError, match='cannot be linked'):
        PtyPort(link.parent / 'no' / 'sink').plug()


def test_bytes_pass_unchanged_both_ways(link):
    port = PtyPort(link)
    port.plug()
    every = bytes(range(256))
    with contextlib.closing(open_port(str(link), 115200, 1.0)) as near:
        near.write(every)
        port.wait(PATIENCE)
        assert port.read() == every
        assert port.write(every) == 256
        read = b''
        while len(read) < 256:
            read += near.read()
        assert read == every
    assert port.read() == b''
    port.unplug()


def test_line_that_nobody_reads_takes_no_more_and_is_no_error(link):
    port = PtyPort(link)
    port.plug()
    while port.write(bytes(1000)):
        pass
    port.unplug()


# ---- sinks on it (what can go wrong: test_sink_line.py)


@pytest.mark.parametrize('flavour', ['home_1_2', 'zstack_3_0'])
def test_host_attaches_writes_nothing_and_gets_everything(sink, host, flavour):
    radio = sink(flavour=flavour)
    before = radio.simulator.device.chip.memory.content
    heard = host().through(radio)
    assert heard.measured == expected(WORLD)
    counters = heard.session.counters
    assert (counters['attached'], counters['lost'], counters['rpc_errors']) == (1, 0, 0)
    assert heard.session.status.sink.version.product == {'home_1_2': 0, 'zstack_3_0': 2}[flavour]
    assert radio.simulator.device.chip.memory.content == before


@pytest.mark.parametrize('flavour', ['home_1_2', 'zstack_3_0'])
def test_host_forms_a_network(sink, host, flavour):
    radio = sink(flavour=flavour, formed=False)
    confirm = f'{radio.simulator.device.chip.memory.ieee:016x}'
    heard = host(form=FormConfig(confirm, 20, 0x1234)).through(radio)
    assert heard.measured == expected(WORLD)
    network = heard.session.status.network
    assert (network.channel, network.pan_id) == (20, 0x1234)


def test_nothing_is_said_before_it_may_begin(sink, host):
    radio = sink()
    heard = host()
    until(lambda: heard.events('up') and radio.simulator.counters['requests'] > 8, 'pings')
    assert heard.measured == []
    assert radio.simulator.sent == []
    assert heard.through(radio).measured == expected(WORLD)


def test_host_can_speak_to_the_nodes(sink, host):
    radio = sink(world=[])
    heard = host()
    heard.until_up()
    radio.may_begin.set()
    until(lambda: radio.loop.begun is not None, 'the beginning')
    heard.session.ask(c.ZdoMgmtLqiReq(0, 0), c.ZdoMgmtLqiReqRsp)
    until(lambda: heard.take() or any(isinstance(i, c.ZdoMgmtLqiRsp) for i, _ in heard.received), 'its neighbours')


# ---- the node and the command


def started(environment, link, *settings):
    words = [str(executable('sink_simulator')), '--ros-args', '-p', f'link:={link}']
    for setting in settings:
        words += ['-p', setting]
    return subprocess.Popen(words, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def test_node_serves_the_bridge_and_tells_the_truth(link):
    """sink_simulator and serial_bridge_node: every measurement arrives, between truths in the same time."""
    with live.private_domain() as environment, observing(environment) as observer:
        rssi = observer.collect(msg.RssiMeasurement, 'rssi', qos.MEASUREMENTS)
        truth = observer.collect(Odometry, 'truth/target_1', qos.FED)
        anchors = observer.collect(msg.Anchors, 'anchors', qos.LATCHED_LAST)
        expecting = 'expected_nodes:=[serial_bridge_node]'
        outputs = 'expected_subscribers:=[truth/target_1=1]'
        sink = started(environment, link, 'rate:=60.0', 'linger:=3.0', expecting, outputs)
        words = [str(executable('serial_bridge_node')), '--ros-args', '-p', f'port:={link}', '-p', 'period:=0.016']
        words += ['-p', 'epoch_timeout:=0.006', '-p', 'expected_subscribers:=[rssi=1]']
        bridge = subprocess.Popen(words, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        try:
            observer.until(lambda: len(rssi) >= 1440, PATIENCE, f'1440 measurements, {len(rssi)} so far')
            output, _ = sink.communicate(timeout=PATIENCE)
        finally:
            sink.kill()
            bridge.kill()
            told, _ = bridge.communicate()
        observer.until(lambda: len(truth) >= 121, PATIENCE, '121 truths')
    assert sink.returncode == 0, output
    assert '120 epochs sent' in output
    assert len(anchors[0].ids) == 12
    assert 'Traceback' not in told
    stamps = [convert.stamp_ns(m.header.stamp) for m in truth]
    measured = [convert.stamp_ns(m.header.stamp) for m in rssi]
    assert stamps == sorted(stamps)
    assert min(measured) >= stamps[0] - MARGIN_NS
    assert max(measured) <= stamps[-1] + MARGIN_NS
    assert not link.is_symlink()


def test_node_that_is_told_to_end_takes_its_link_away(link):
    with live.private_domain() as environment, observing(environment) as observer:
        ready = observer.collect(String, 'ready', qos.LATCHED)
        process = started(environment, link)
        try:
            observer.until(lambda: bool(ready), PATIENCE, 'that it is ready')
            assert link.is_symlink()
            process.send_signal(signal.SIGTERM)
            output, _ = process.communicate(timeout=PATIENCE)
        finally:
            process.kill()
    assert process.returncode == 0, output
    assert 'Traceback' not in output
    assert not link.is_symlink()


@pytest.mark.parametrize(
    ('setting', 'words'),
    [
        ('faults:=[nonsense]', ['nonsense', 'garbage']),
        ('link:=/no/such/folder/sink', ['/no/such/folder/sink']),
        ('traffic.payload:=morse', ['traffic.payload', 'worn']),
    ],
)
def test_bad_parameter_is_refused_in_one_line(link, setting, words):
    with live.private_domain() as environment:
        process = started(environment, link, setting)
        output, _ = process.communicate(timeout=PATIENCE)
    assert process.returncode == 2
    (line,) = output.strip().splitlines()
    assert line.startswith('error: ')
    for word in words:
        assert word in line


RUN = """
import argparse, sys
from wsn_tracking.commands import sink_simulate
parser = argparse.ArgumentParser()
sink_simulate.add(parser.add_subparsers())
options = parser.parse_args(sys.argv[1:])
sys.exit(options.do(options))
"""


def test_command_needs_no_ros_and_ends_when_told(link, host):
    words = [sys.executable, '-c', RUN, 'simulate', '--link', str(link), '--rate', '40', '--fault', 'garbage=0.5']
    process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    try:
        heard = host()
        lines = [process.stdout.readline().rstrip() for _ in range(3)]
        until(lambda: len(heard.measured) >= 1440, 'all measurements')
        process.send_signal(signal.SIGTERM)
        output, _ = process.communicate(timeout=PATIENCE)
    finally:
        process.kill()
    assert process.returncode == 0, output
    lines += output.splitlines()
    assert lines[0].startswith(f'{link} -> /dev/pts/')
    assert lines[1:3] == ['a host listens: the nodes speak', 'all was sent']
    assert 'messages 144' in lines[3]
    assert 'Garbage' in lines[3]
    assert not link.is_symlink()


def test_command_ends_by_itself_and_refuses_what_it_does_not_know(link, capsys, host):
    parser = argparse.ArgumentParser()
    sink_simulate.add(parser.add_subparsers())

    def run(*words):
        options = parser.parse_args(['simulate', '--link', str(link), *words])
        return options.do(options)

    heard = host()
    assert run('--bag', str(live.A_LOOP), '--rate', 'max', '--linger', '0.01', '--set', 'traffic.heartbeat=0') == 0
    assert 'messages 1440' in capsys.readouterr().out
    assert heard.session.counters['opened'] == 1
    for words in (['--set', 'traffic.colour=1'], ['--fault', 'nonsense'], ['--set', 'baud=-1']):
        with pytest.raises(TrackingError, match='expected'):
            run(*words)
    with pytest.raises(SystemExit):
        run('--linger', '-1')
    assert not link.is_symlink()

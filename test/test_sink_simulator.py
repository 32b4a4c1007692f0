"""The simulated sink as a node and as a command."""

from __future__ import annotations

import argparse
import signal
import subprocess
import sys

import pytest
from nav_msgs.msg import Odometry
from std_msgs.msg import String
from wsn_tracking_msgs import msg

import live
from observer import observing
from radio import PATIENCE, until
from wsn_tracking.commands import sink_simulate
from wsn_tracking.errors import TrackingError
from wsn_tracking.nodes import convert, qos
from wsn_tracking.processes import executable

MARGIN_NS = 200_000_000  # what a busy machine may hold up every message of a run


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

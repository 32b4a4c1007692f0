"""Processes of a graph: started with their own parameters, watched, and never left behind."""

from __future__ import annotations

import os
import signal
import sys
import threading
import time

import pytest
import yaml

from wsn_tracking import processes
from wsn_tracking.errors import TrackingError
from wsn_tracking.graphs import Process
from wsn_tracking.processes import command, declared, executable, run_graph, write_parameters

STAY = 'import signal, sys; signal.signal(signal.SIGTERM, lambda *_: sys.exit(0)); signal.pause()'


@pytest.fixture
def installed(tmp_path, monkeypatch):
    """Makes executables of this package that run a line of Python; each notes its process id."""
    folder = tmp_path / 'lib' / 'wsn_tracking'
    folder.mkdir(parents=True)
    monkeypatch.setenv('AMENT_PREFIX_PATH', f'/nowhere:{tmp_path}')
    monkeypatch.setattr(processes, 'POLL', 0.005)

    def install(name, code):
        path = folder / name
        note = f'import os; open({str(tmp_path / name)!r} + ".pid", "w").write(str(os.getpid()))'
        path.write_text(f'#!{sys.executable} -IS\n{note}\n{code}\n')
        path.chmod(0o755)
        return path

    install.folder = tmp_path
    return install


def until(condition):
    """Python that waits for a condition; what cannot be told yet is not met."""
    return f"""
import os, time
end = time.monotonic() + 20
while time.monotonic() < end:
    try:
        if {condition}: break
    except (OSError, IndexError): pass
    time.sleep(.002)
"""


def alive(installed, name):
    """Whether the process that an executable has become still runs."""
    pid = installed.folder / f'{name}.pid'
    if not pid.exists():
        return False
    try:
        os.kill(int(pid.read_text() or 0), 0)
    except ProcessLookupError:
        return False
    return True


def process(executable_, name=None, **parameters):
    return Process(executable_, name or executable_, parameters)


# ---- parameters


def test_a_process_gets_what_its_executable_declares(tmp_path):
    one = process(
        'sensing_node', 'sensing_3', ids=(3,), seed=7, lossless=True, peers=[1, 2], expected_publishers=['rssi=1'],
        nonsense=1, use_sim_time=True,
        **{'trigger.kind': 'near', 'trigger.y_min': -46.9, 'noise.q_max': 3.0},
        **{'qos_overrides./range.publisher.depth': 9},
    )  # fmt: skip
    known = {
        'use_sim_time': True, 'qos_overrides./range.publisher.depth': 9,
        'ids': (3,), 'seed': 7, 'lossless': True, 'trigger.kind': 'near', 'trigger.y_min': -46.9,
        'expected_publishers': ['rssi=1'],
    }  # fmt: skip
    assert declared(one) == known
    path = write_parameters(one, tmp_path)
    assert yaml.safe_load(path.read_text()) == {'/**': {'ros__parameters': {**known, 'ids': [3]}}}


def test_an_empty_list_is_left_out_since_ros_files_cannot_say_it(tmp_path):
    path = write_parameters(process('estimator_node', nodes=(), peers=[]), tmp_path)
    assert yaml.safe_load(path.read_text()) == {'/**': {'ros__parameters': {}}}


def test_a_command_is_what_ros2_run_would_start(installed, tmp_path):
    path = installed('sensing_node', '')
    assert command(process('sensing_node', 'sensing_3'), tmp_path / 'p.yaml') == [
        str(path), '--ros-args', '-r', '__node:=sensing_3', '--params-file', str(tmp_path / 'p.yaml')
    ]  # fmt: skip


def test_what_is_not_installed_is_an_error_that_says_what_to_do(installed):
    with pytest.raises(TrackingError, match='estimator_node is not installed: build the workspace'):
        executable('estimator_node')


# ---- running


def test_the_graph_ends_when_the_last_ones_have(installed):
    installed('evaluator_node', '')
    installed('bag_recorder_node', '')
    installed('estimator_node', STAY)
    graph = [process('estimator_node'), process('evaluator_node'), process('bag_recorder_node')]
    assert run_graph(graph, ['evaluator_node', 'bag_recorder_node']) == 0
    assert not any(alive(installed, p.name) for p in graph)


def test_an_error_of_any_process_is_named_and_is_the_result(installed, capfd):
    """The others go on without it."""
    installed('estimator_node', 'raise SystemExit(3)')
    folder = f'"/proc/" + open({str(installed.folder / "estimator_node.pid")!r}).read()'
    gone = f'len({folder}) > 6 and (not os.path.exists({folder}) or open({folder} + "/stat").read().split()[2] == "Z")'
    installed('evaluator_node', until(gone))
    assert run_graph([process('estimator_node'), process('evaluator_node')], ['evaluator_node']) == 3
    assert capfd.readouterr().err == 'estimator_node ended with code 3\n'


def test_a_feed_that_fails_ends_the_graph_after_a_grace(installed, capfd, monkeypatch):
    monkeypatch.setattr(processes, 'FAREWELL', 0.2)
    installed('bag_player_node', 'raise SystemExit(2)')
    installed('evaluator_node', STAY)
    assert run_graph([process('evaluator_node'), process('bag_player_node', 'bag_player')], ['evaluator_node']) == 2
    assert 'bag_player ended with code 2' in capfd.readouterr().err
    assert not alive(installed, 'evaluator_node')


def test_a_process_that_does_not_listen_is_killed(installed, monkeypatch):
    monkeypatch.setattr(processes, 'GRACE', 0.05)
    deaf = str(installed.folder / 'deaf')
    ignore = 'import signal; signal.signal(signal.SIGTERM, signal.SIG_IGN)'
    installed('estimator_node', f'{ignore}; open({deaf!r}, "w")\nwhile True: signal.pause()')
    installed('evaluator_node', until(f'os.path.exists({deaf!r})'))
    assert run_graph([process('estimator_node'), process('evaluator_node')], ['evaluator_node']) == 0
    assert not alive(installed, 'estimator_node')


def test_nothing_to_wait_for_is_an_error():
    assert run_graph([], []) == 1


def test_when_one_cannot_be_started_the_others_are_ended(installed):
    """They live in sessions of their own: nobody else would end them."""
    installed('estimator_node', STAY)
    installed('evaluator_node', '').chmod(0o644)
    graph = [process('estimator_node'), process('evaluator_node')]
    with pytest.raises(TrackingError, match='evaluator_node cannot be started'):
        run_graph(graph, ['evaluator_node'])
    assert not alive(installed, 'estimator_node')


def test_what_cannot_be_executed_is_an_error_of_ours(installed):
    installed('evaluator_node', '').chmod(0o644)
    with pytest.raises(TrackingError, match=r'evaluator_node cannot be started \(Permission denied\)'):
        run_graph([process('evaluator_node')], ['evaluator_node'])


@pytest.fixture
def heard():
    """Signals that nobody ignores: who runs tests side by side ignores SIGINT, nohup SIGHUP."""
    numbers = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    before = [signal.signal(number, lambda *_: None) for number in numbers]
    yield
    for number, handler in zip(numbers, before, strict=True):
        signal.signal(number, handler)


def send_when(path, *numbers):
    """A thread that sends these signals to this program once a process has written a file."""

    def send():
        deadline = time.monotonic() + 10.0
        while not (path.exists() and path.read_text()) and time.monotonic() < deadline:
            time.sleep(0.002)
        for number in numbers:
            os.kill(os.getpid(), number)

    sender = threading.Thread(target=send)
    sender.start()
    return sender


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_ends_all_of_it(installed, heard, number):
    """What a user, `timeout`, make or a closed terminal sends."""
    installed('estimator_node', STAY)
    before = signal.getsignal(number)
    sender = send_when(installed.folder / 'estimator_node.pid', number)
    with pytest.raises(KeyboardInterrupt):
        run_graph([process('estimator_node')], ['estimator_node'])
    sender.join()
    assert not alive(installed, 'estimator_node')
    assert signal.getsignal(number) is before


def test_a_second_request_leaves_nobody_behind_and_lets_all_end_in_order(installed, heard):
    """A recorder that is closing its bag when Ctrl-C is pressed again, and the terminal closed."""
    closing, going, closed = (installed.folder / name for name in ('closing', 'going', 'closed'))
    close = until(f'os.path.exists({str(going)!r})')
    installed(
        'bag_recorder_node',
        f"""
import signal
def end(*_):
    open({str(closing)!r}, 'w').write('begun')
    exec({close!r})
    open({str(closed)!r}, 'w')
    raise SystemExit
signal.signal(signal.SIGTERM, end)
open({str(installed.folder / 'listens')!r}, 'w').write('now')
signal.pause()
""",
    )
    asked = send_when(installed.folder / 'listens', signal.SIGINT)
    again = send_when(closing, signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    let = threading.Thread(target=lambda: (again.join(), going.touch()))
    let.start()
    with pytest.raises(KeyboardInterrupt):
        run_graph([process('bag_recorder_node')], ['bag_recorder_node'])
    for thread in (asked, let):
        thread.join()
    assert closed.exists()
    assert not alive(installed, 'bag_recorder_node')


def test_what_the_caller_ignores_stays_ignored(installed):
    """`nohup wsn-tracking replay ... &`, and the terminal is closed."""
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        installed('evaluator_node', until(f'os.path.exists({str(installed.folder / "sent")!r})'))
        sender = send_when(installed.folder / 'evaluator_node.pid', signal.SIGHUP)
        then = threading.Thread(target=lambda: (sender.join(), (installed.folder / 'sent').touch()))
        then.start()
        assert run_graph([process('evaluator_node')], ['evaluator_node']) == 0
        then.join()
        assert signal.getsignal(signal.SIGHUP) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGHUP, before)


def test_it_runs_in_a_thread_too(installed):
    """Where no signal can be handled."""
    installed('evaluator_node', 'raise SystemExit(4)')
    codes = []
    thread = threading.Thread(target=lambda: codes.append(run_graph([process('evaluator_node')], ['evaluator_node'])))
    thread.start()
    thread.join()
    assert codes == [4]


def test_a_process_is_out_of_reach_of_the_terminal(installed):
    """Ctrl-C reaches the program alone, which then ends all in order."""
    installed('evaluator_node', f'open({str(installed.folder / "sid")!r}, "w").write(str(os.getsid(0)))')
    assert run_graph([process('evaluator_node')], ['evaluator_node']) == 0
    assert int((installed.folder / 'sid').read_text()) not in {0, os.getsid(0)}


def test_a_value_that_a_node_would_refuse_is_told_before_anything_starts(installed):
    """Whoever waited for it would wait in vain."""
    installed('estimator_node', STAY)
    installed('world_node', '')
    graph = [process('estimator_node'), process('world_node', seed=-3)]
    with pytest.raises(TrackingError, match=r'parameter `seed` is -3: expected an integer >= 0'):
        run_graph(graph, ['estimator_node'])
    assert not (installed.folder / 'estimator_node.pid').exists()


def test_a_process_that_is_still_starting_ends_without_a_word(installed, heard, capfd):
    """Python that is importing answers SIGINT with a traceback, and a graph has many processes."""
    installed('estimator_node', until('False'))
    sender = send_when(installed.folder / 'estimator_node.pid', signal.SIGINT)
    with pytest.raises(KeyboardInterrupt):
        run_graph([process('estimator_node')], ['estimator_node'])
    sender.join()
    assert capfd.readouterr().err == ''

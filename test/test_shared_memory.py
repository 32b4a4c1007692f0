"""What killed processes leave in shared memory keeps no node from starting."""

from __future__ import annotations

import os
import signal
import subprocess
import time
from pathlib import Path

import pytest

import live
from wsn_tracking.nodes.shared_memory import FOLDER, remove_unfinished
from wsn_tracking.processes import executable

TIMEOUT = 120.0  # [s] far beyond what a start takes on a busy machine
AGE = 60.0  # [s]


def left_behind(path: Path, content: bytes = b'', age: float = AGE) -> Path:
    path.write_bytes(content)
    then = time.time() - age
    os.utime(path, (then, then))
    return path


def test_only_ports_without_a_size_that_nobody_is_making_are_removed(tmp_path):
    kept = [
        left_behind(tmp_path / 'fastrtps_port7411', b'x'),
        left_behind(tmp_path / 'fastrtps_port7411_el'),
        left_behind(tmp_path / 'fastrtps_port7413', age=0.0),
        left_behind(tmp_path / 'fastrtps_00ff'),
        left_behind(tmp_path / 'somebody_elses'),
    ]
    gone = [left_behind(tmp_path / f'fastrtps_port{number}') for number in (7415, 7417)]
    assert remove_unfinished(tmp_path) == 2
    assert all(path.exists() for path in kept)
    assert not any(path.exists() for path in gone)
    assert remove_unfinished(tmp_path / 'no_such_folder') == 0


@pytest.mark.skipif(not os.access(FOLDER, os.W_OK), reason=f'no {FOLDER} to write to')
def test_a_node_starts_on_a_port_that_a_killed_process_had_begun():
    with live.private_domain() as environment:
        first = 7411 + 250 * int(environment['ROS_DOMAIN_ID'])  # of a participant's user data; a participant has two
        ports = [left_behind(FOLDER / f'fastrtps_port{first + 2 * number}') for number in range(8)]
        process = subprocess.Popen([str(executable('sensing_node'))], env=environment, stderr=subprocess.DEVNULL)
        try:
            deadline = time.monotonic() + TIMEOUT
            maps = Path(f'/proc/{process.pid}/maps')
            while not any(f'{port}\n' in maps.read_text() and port.stat().st_size for port in ports if port.exists()):
                assert time.monotonic() < deadline, 'the node did not open its port'
                time.sleep(0.05)
            process.send_signal(signal.SIGINT)
            assert process.wait(TIMEOUT) == 0
        finally:
            process.kill()
            for port in ports:
                port.unlink(missing_ok=True)

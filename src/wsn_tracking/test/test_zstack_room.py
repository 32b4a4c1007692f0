import ast
import sys
from pathlib import Path

import pytest

from wsn_tracking import zstack

FILES = sorted(Path(zstack.__file__).parent.rglob('*.py'))
HOME = ('wsn_tracking.errors', 'wsn_tracking.parameters', 'wsn_tracking.zstack')


def imported(path):
    for node in ast.walk(ast.parse(path.read_text('utf-8'))):
        if isinstance(node, ast.Import):
            yield from (name.name for name in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield node.module


@pytest.mark.parametrize('path', FILES, ids=lambda path: path.stem)
def test_room_knows_only_bytes(path):
    """The standard library and itself; the serial port in one module, threads in two."""
    extra = {'port': {'serial'}}.get(path.stem, set())
    for name in imported(path):
        assert name.startswith(HOME) or name.partition('.')[0] in sys.stdlib_module_names | extra
    threads = 'threading' in imported(path)
    assert threads == (path.stem in {'session', 'queues'})

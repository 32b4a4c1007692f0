"""Reference pages made from the code: `python -m wsn_tracking.documentation docs`."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from wsn_tracking.bags.types import message_folder
from wsn_tracking.node_parameters.common import NodeConfig
from wsn_tracking.node_parameters.executables import EXECUTABLES
from wsn_tracking.parameters import Spec, specs


def parameters_page() -> str:
    """Every parameter of every executable: name, default, what it may be, and why it is there."""
    lines = [
        '# Parameters',
        '',
        'Made by `python -m wsn_tracking.documentation docs`; a test holds it against the code.',
        '',
        'All are read when a node starts; a bad value ends it with one line that says what was expected. Lists take',
        'YAML (`-p nodes:=[1,2]`). A configuration file (`config/*.yaml`) sets them for every node (`/**`) or for one',
        '(`/**/estimator_1`).',
    ]
    for name, kind in EXECUTABLES.items():
        lines += ['', f'## {name}', '', *_table(specs(kind))]
    lines += ['', '## Every node', '', *_table(specs(NodeConfig))]
    return '\n'.join(lines) + '\n'


def messages_page() -> str:
    """The message definitions, comments and all."""
    lines = [
        '# Messages of wsn_tracking_msgs',
        '',
        'Made by `python -m wsn_tracking.documentation docs`; a test holds it against the definitions.',
    ]
    for path in sorted(message_folder().glob('*.msg')):
        lines += ['', f'## {path.stem}', '', '```', path.read_text('utf-8').rstrip(), '```']
    return '\n'.join(lines) + '\n'


PAGES: Mapping[str, Any] = {'parameters.md': parameters_page, 'messages.md': messages_page}


def _table(rows: Iterator[Spec]) -> Iterator[str]:
    yield '| parameter | default | is | why |'
    yield '|---|---|---|---|'
    for spec in rows:
        yield f'| `{spec.name}` | `{_shown(spec.default)}` | {_cell(spec.expected)} | {_cell(spec.why)} |'


def _shown(default: Any) -> str:
    if isinstance(default, tuple):
        return str([value for value in default if value != ''])
    return repr(default) if isinstance(default, str) else str(default).lower()


def _cell(text: str) -> str:
    return text.replace('|', '\\|')


def main() -> None:
    """Write the pages into the folder that is named."""
    for name, page in PAGES.items():
        Path(sys.argv[1], name).write_text(page(), 'utf-8')


if __name__ == '__main__':
    main()

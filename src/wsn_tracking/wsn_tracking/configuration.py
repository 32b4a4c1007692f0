"""Configuration files: parameters of the nodes of a graph.

A file is a ROS 2 parameter file: section `/**` is for every node, `/**/NAME` for one. The same file serves
`ros2 run --params-file`, the launch files and the evaluator.
"""

from __future__ import annotations

import difflib
import fnmatch
import os
from collections.abc import Collection, Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

from wsn_tracking.errors import TrackingError
from wsn_tracking.node_parameters.common import NodeConfig
from wsn_tracking.node_parameters.executables import EXECUTABLES
from wsn_tracking.parameters import Values, specs


def share_folders(*parts: str) -> Iterator[Path]:
    """Where installed data of this package may be, most specific first; the sources come last."""
    for prefix in filter(None, os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep)):
        yield Path(prefix, 'share', 'wsn_tracking', *parts)
    yield Path(__file__).resolve().parents[1].joinpath(*parts)


def configuration_names() -> list[str]:
    """Configurations that come with the package."""
    return sorted({path.stem for folder in share_folders('config') for path in folder.glob('*.yaml')})


def find_configuration(name: str) -> Path:
    """The file of a configuration, by path or by the name of one that comes with the package."""
    candidates = [Path(name), *(folder / f'{name}.yaml' for folder in share_folders('config'))]
    for path in candidates:
        if os.path.isfile(path):  # noqa: PTH113 (pathlib raises where a name is too long)
            return path
    raise TrackingError(
        f'no configuration `{name}`: expected a file or one of {", ".join(configuration_names()) or "(none found)"}'
    )


class Configuration:
    """The sections of a parameter file."""

    def __init__(self, sections: Mapping[str, Values]) -> None:
        self._sections = sections

    def of(self, node: str) -> dict[str, Any]:
        """The parameters that the file sets for a node of that name."""
        values: dict[str, Any] = {}
        for section in ('/**', f'/**/{node}', f'/{node}', node):
            values.update(self._sections.get(section, {}))
        return values

    def but(self, *nodes: str) -> Configuration:
        """Without what is for nodes of these names alone, which may hold `*`."""
        kept = {name: v for name, v in self._sections.items() if not _is_any(name.rpartition('/')[2], nodes)}
        return Configuration(kept)

    def check_sections(self, nodes: Collection[str]) -> None:
        """Raise TrackingError for a section that is of none of these nodes: it would have no effect."""
        for section in self._sections:
            name = section.rpartition('/')[2]
            if section != '/**' and name not in nodes:
                near = difflib.get_close_matches(name, nodes, 1)
                hint = f'did you mean `{near[0]}`?' if near else f'expected one of {", ".join(sorted(nodes))}'
                raise TrackingError(f'section `{section}` is of no node of this graph; {hint}')


def _is_any(name: str, patterns: Iterable[str]) -> bool:
    return any(fnmatch.fnmatchcase(name, pattern) for pattern in patterns)


def load_configuration(name: str) -> Configuration:
    """Read and check a configuration; an unknown parameter is refused with the nearest known one."""
    from wsn_tracking.ros_yaml import parse

    path = find_configuration(name)
    try:
        text = path.read_text('utf-8')
    except (OSError, UnicodeDecodeError) as error:
        raise TrackingError(f'{path} cannot be read as text: {error}') from error
    content = parse(text, str(path))
    if not isinstance(content, dict):
        raise TrackingError(f'{path} holds no sections: expected `/**:` with `ros__parameters:` below it')
    sections = {}
    for section, body in content.items():
        if not isinstance(body, dict) or not isinstance(body.get('ros__parameters'), dict):
            raise TrackingError(f'{path}: section `{section}` has no `ros__parameters:` with names below it')
        sections[str(section)] = dict(_flat(body['ros__parameters']))
        for parameter in sections[str(section)]:
            check_known(parameter, str(path))
    return Configuration(sections)


def parse_setting(text: str) -> tuple[str, Any]:
    """name=value of the command line; the value is YAML."""
    name, separator, value = text.partition('=')
    if not separator:
        raise TrackingError(f'setting {text!r}: expected name=value, e.g. trigger.kind=near')
    check_known(name, f'setting {text!r}')
    from wsn_tracking.ros_yaml import parse  # no node needs it: ROS reads parameter files for them

    return name, parse(value, f'setting {text!r}')


def _flat(values: Mapping[str, Any], prefix: str = '') -> Iterator[tuple[str, Any]]:
    for key, value in values.items():
        if isinstance(value, dict):
            yield from _flat(value, f'{prefix}{key}.')
        else:
            yield f'{prefix}{key}', value


@cache
def _known() -> frozenset[str]:
    return frozenset(spec.name for kind in (*EXECUTABLES.values(), NodeConfig) for spec in specs(kind))


def is_of_ros(name: str) -> bool:
    """Whether a parameter is one that ROS 2 gives to every node."""
    return name == 'use_sim_time' or name.startswith('qos_overrides.')


def check_known(name: str, where: str) -> None:
    """Raise TrackingError, with the nearest name, for a parameter that no executable has."""
    known = _known()
    if name in known or is_of_ros(name):
        return
    near = difflib.get_close_matches(name, sorted(known), 1)
    hint = f'did you mean `{near[0]}`?' if near else 'docs/parameters.md lists all'
    raise TrackingError(f'{where}: there is no parameter `{name}`; {hint}')

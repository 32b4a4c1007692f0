"""YAML as ROS 2 reads parameter files; imported where a file is read or written, since no node needs it."""

from __future__ import annotations

import re
from typing import Any

import yaml

from wsn_tracking.errors import TrackingError


class _Loader(yaml.SafeLoader):  # type: ignore[misc]
    """1e-3 is a number, as for ROS 2 and for people; PyYAML alone takes it for a text."""


_Loader.add_implicit_resolver(
    'tag:yaml.org,2002:float', re.compile(r'[-+]?(\d+\.?\d*|\.\d+)[eE][-+]?\d+$'), list('-+.0123456789')
)


class _Dumper(yaml.SafeDumper):  # type: ignore[misc]
    """Texts in quotes: ROS 2 takes `y`, `1e5` and `nan` for what they look like, PyYAML does not."""


_Dumper.add_representer(str, lambda dumper, text: dumper.represent_scalar('tag:yaml.org,2002:str', text, style='"'))


def dump(content: Any) -> str:
    """A YAML text of plain values, which ROS 2 reads as the same values."""
    return str(yaml.dump(content, Dumper=_Dumper))


def parse(text: str, where: str) -> Any:
    """The value of a YAML text; TrackingError, which begins with `where`, for what is none."""
    try:
        return yaml.load(text, _Loader)  # noqa: S506 (it is a SafeLoader)
    except (yaml.YAMLError, ValueError, TypeError, LookupError, AttributeError, RecursionError) as error:
        # all but the first are what SafeLoader's constructors let through, e.g. for the thirteenth month
        reason = ' '.join(str(error).split()) or type(error).__name__
        raise TrackingError(f'{where}: no readable YAML: {reason}') from error

"""YAML as ROS 2 reads parameter files; imported where a file is read, since no node needs it."""

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


def parse(text: str, where: str) -> Any:
    """The value of a YAML text; TrackingError, which begins with `where`, for what is none."""
    try:
        return yaml.load(text, _Loader)  # noqa: S506 (it is a SafeLoader)
    except (yaml.YAMLError, ValueError, TypeError, LookupError, AttributeError, RecursionError) as error:
        # all but the first are what SafeLoader's constructors let through, e.g. for the thirteenth month
        reason = ' '.join(str(error).split()) or type(error).__name__
        raise TrackingError(f'{where}: no readable YAML: {reason}') from error

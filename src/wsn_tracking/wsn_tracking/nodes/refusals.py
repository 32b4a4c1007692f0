"""What rclpy refuses when a node is started, in one line: files and values of `--ros-args`, names of topics."""

from __future__ import annotations

import re

from rclpy.exceptions import NameValidationException, ParameterException
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy

REFUSALS = (_rclpy.RCLError, _rclpy.UnknownROSArgsError, NameValidationException, ParameterException)
PLACE = re.compile(r',? at /\S+:\d+')  # in the sources of ROS 2, of use to nobody who starts a node


def one_line(error: Exception) -> str:
    """What was refused and why."""
    if isinstance(error, _rclpy.UnknownROSArgsError):
        return f'{error} after --ros-args: expected -p NAME:=VALUE, -r FROM:=TO or --params-file FILE'
    return ' '.join(PLACE.sub('', str(error)).split()).rstrip(' ,^')

"""Channels in files, as `calibrate` writes them and nodes, importers and the evaluator read them."""

from __future__ import annotations

import logging
from pathlib import Path

from wsn_tracking.errors import TrackingError
from wsn_tracking.files import read_whole, write_whole
from wsn_tracking.models.anchors import Anchors
from wsn_tracking.models.radio_map import RadioMap
from wsn_tracking.sensing.channel import Body, Channel, apply, lacking
from wsn_tracking.sensing.channel_text import channel_text


def calibrated(path: str, anchors: Anchors) -> tuple[Anchors, RadioMap | None]:
    """The anchors with the radio of a channel file, and its map; as they are where the path is empty.

    Nodes that the file lacks keep the radio of the anchors, which is said in a warning.
    """
    if not path:
        return anchors, None
    channel = load_channel(path)
    try:
        absent = lacking(channel, anchors)
    except TrackingError as error:
        raise TrackingError(f'{path}: {error}') from None
    if absent:
        logging.getLogger(__name__).warning(
            '%s lacks nodes %s: they keep the radio of the anchors, uncalibrated', path, list(absent)
        )
    return apply(channel, anchors), channel.radio_map


def body_of(path: str) -> Body | None:
    """The body in a channel file; None where it tells of none, or the path is empty."""
    return load_channel(path).body if path else None


def check_channel(path: str) -> None:
    """Raise TrackingError where a path that is given leads to no channel: before anything starts, not within."""
    if path:
        load_channel(path)


def load_channel(path: Path | str) -> Channel:
    """Read a channel file; TrackingError where it is none."""
    from wsn_tracking.sensing.channel_parse import parse_channel  # a node without a channel needs no YAML

    try:
        text = read_whole(path).decode('utf-8')
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else 'it is no text'
        raise TrackingError(f'channel {path} cannot be read ({reason}): expected a file of `calibrate`') from error
    return parse_channel(text, str(path))


def save_channel(path: Path | str, channel: Channel) -> None:
    """Write a channel file, whole or not at all; an existing file is replaced."""
    write_whole(path, channel_text(channel).encode())

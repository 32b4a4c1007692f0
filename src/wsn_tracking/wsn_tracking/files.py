"""Files on disk: whole or not at all."""

from __future__ import annotations

import contextlib
import os
import stat
import tempfile
from pathlib import Path

from wsn_tracking.errors import TrackingError

ENDLESS = 2**26  # [bytes] of what is no regular file: beyond, nobody waits for the end of it


def read_whole(path: str | Path) -> bytes:
    """The content of a file or a pipe. OSError where it cannot be read, TrackingError where it does not end."""
    with Path(path).open('rb') as stream:
        if stat.S_ISREG(os.fstat(stream.fileno()).st_mode):
            return stream.read()
        content = stream.read(ENDLESS + 1)
    if len(content) > ENDLESS:
        raise TrackingError(f'{path} does not end: a file is expected')
    return content


def check_new_folder(path: str | Path) -> None:
    """Raise TrackingError where a folder of that name is there, or cannot be made."""
    wanted = Path(path)
    try:
        wanted.mkdir(parents=True)
        wanted.rmdir()
    except FileExistsError:
        raise TrackingError(f'{wanted} exists: name another folder or remove it') from None
    except OSError as error:
        raise TrackingError(f'{wanted} cannot be made ({error.strerror}): name a folder in one that you own') from error


def check_folder(path: str | Path) -> None:
    """Raise TrackingError where nothing can be written into a folder of that name; it need not be there yet."""
    wanted = Path(path)
    missing = [folder for folder in (wanted, *wanted.parents) if not folder.exists()]
    try:
        wanted.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=wanted).close()
    except OSError as error:
        raise TrackingError(
            f'{wanted} cannot be written ({error.strerror}): name a folder that you own, or a new one in it'
        ) from error
    finally:
        for folder in missing:
            with contextlib.suppress(OSError):
                folder.rmdir()


def write_whole(path: str | Path, content: bytes) -> None:
    """Write a file through a neighbour that is renamed, so that nobody ever reads half of it.

    Missing folders are made. What is not a regular file (a pipe, /dev/stdout) is written directly.
    Raises TrackingError where the file cannot be written; what was there before then stays.
    """
    wanted = Path(path)
    try:
        if wanted.exists() and not wanted.is_file() and not wanted.is_dir():
            wanted.write_bytes(content)
            return
        target = Path(os.path.realpath(wanted))  # a link stays a link
        target.parent.mkdir(parents=True, exist_ok=True)
        part = target.with_name(f'.{target.name}.{os.getpid()}.part')
        try:
            part.write_bytes(content)
            part.replace(target)
        finally:
            part.unlink(missing_ok=True)
    except OSError as error:
        raise TrackingError(
            f'{wanted} cannot be written ({error.strerror or error}): name a file in a folder that you own'
        ) from error

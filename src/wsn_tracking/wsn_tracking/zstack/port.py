"""The serial port: opened exclusively, read and written without loss, and errors that say what to do."""

from __future__ import annotations

import errno
import os
import select
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import serial  # type: ignore[import-untyped]

from wsn_tracking.errors import TrackingError

DEV = Path('/dev')
PATTERNS = ('serial/by-id/*', 'ttyACM*', 'ttyUSB*')
BYTES = 65536  # read at once
TOGGLE_S = 0.15


class Port:
    """An open serial port; every failure of it is a TrackingError."""

    def __init__(self, line: serial.Serial, name: str) -> None:
        self._line = line
        self.name = name
        self.device = os.path.realpath(name)

    def fileno(self) -> int:
        """For `select`."""
        return int(self._line.fd)

    def read(self) -> bytes:
        """What has arrived; b'' is nothing yet."""
        with self._failing('read'):
            return bytes(self._line.read(BYTES))

    def write(self, data: bytes) -> None:
        """Send, waiting no longer than the time given at opening."""
        with self._failing('written to'):
            self._line.write(data)

    def toggle(self) -> None:
        """Pulse DTR and RTS, which resets a sink that is wired so; a port without such lines fails."""
        with self._failing('reset by DTR and RTS (set toggle_dtr_rts to false)'):
            for dtr, rts in ((False, False), (False, True), (False, False)):
                self._line.dtr, self._line.rts = dtr, rts
                select.select([], [], [], TOGGLE_S)

    def close(self) -> None:
        """Give the port back."""
        with self._failing('closed'):
            self._line.close()

    @contextmanager
    def _failing(self, what: str) -> Iterator[None]:
        try:
            yield
        except (OSError, ValueError, TypeError) as error:  # pyserial: TypeError when it has been closed meanwhile
            hint = (
                'rtscts may have to be false'
                if isinstance(error, serial.SerialTimeoutException)
                else 'still plugged in?'
            )
            raise TrackingError(f'{self.name} cannot be {what} ({_reason(error)}): {hint}') from None


def open_port(name: str, baud: int, write_s: float, *, rtscts: bool = False) -> Port:
    """Open a port, 8N1, for this process alone; the path is resolved anew, so that it may have moved."""
    try:
        line = serial.Serial(name, baud, timeout=0, write_timeout=write_s, rtscts=rtscts, exclusive=True)
    except (OSError, ValueError) as error:
        raise TrackingError(_why(name, error)) from None
    return Port(line, name)


def ports() -> list[str]:
    """The serial ports that there are, those with lasting names first."""
    return [str(path) for pattern in PATTERNS for path in sorted(DEV.glob(pattern))]


def _why(name: str, error: Exception) -> str:
    number = getattr(error, 'errno', None)
    if number in {errno.ENOENT, errno.ENOTDIR}:
        found = ', '.join(ports()) or 'none; is the sink plugged in?'
        return f'no such port: {name}; serial ports here: {found}'
    if number in {errno.EACCES, errno.EPERM}:
        return (
            f'no permission to open {name}: your user has to be in the group of serial ports '
            '(sudo usermod -aG dialout $USER, then log in again)'
        )
    if number in {errno.EBUSY, errno.EAGAIN, errno.EWOULDBLOCK}:
        return f'{name} is in use by another program (fuser {name} shows which): close it first'
    return f'{name} cannot be opened as a serial port ({_reason(error)}): expected a tty'


def _reason(error: BaseException) -> str:
    number = getattr(error, 'errno', None)
    if isinstance(number, int):
        return os.strerror(number)
    if isinstance(error, serial.SerialException) and error.__context__ is not None:  # pyserial's words quote another's
        return _reason(error.__context__)
    if 'returned no data' in str(error):  # how pyserial sees a line that was hung up
        return 'it was hung up'
    return str(error.args[-1]) if error.args else type(error).__name__

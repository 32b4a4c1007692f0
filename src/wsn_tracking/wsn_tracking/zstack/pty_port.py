"""A serial port that a program lives behind: a pseudo terminal under a name that stays."""

from __future__ import annotations

import contextlib
import errno
import os
import select
import tty
from pathlib import Path

from wsn_tracking.errors import TrackingError

BYTES = 65536


class PtyPort:
    """The far end of a serial line. `link` is a symbolic link to whatever device it has at present."""

    def __init__(self, link: str | Path) -> None:
        self.link = Path(link)
        self.device = ''
        self._master = self._slave = -1
        self._old_slave = -1  # held so that the next device gets another name

    @property
    def plugged(self) -> bool:
        """Whether there is a device."""
        return self._master >= 0

    def fileno(self) -> int:
        """For `select`."""
        return self._master

    def plug(self) -> None:
        """Appear. The name of the device is new where someone still holds the old one."""
        if self.plugged:
            return
        if self.link.exists() and not self.link.is_symlink():
            raise TrackingError(f'{self.link} is no symbolic link: it is not replaced; name another path for the port')
        master, slave = os.openpty()
        tty.setraw(slave)  # our own end of it stays open, so that it stays raw when a host leaves
        os.set_blocking(master, False)
        self._master, self._slave, self.device = master, slave, os.ttyname(slave)
        aside = self.link.with_name(f'.{self.link.name}.{os.getpid()}')
        try:
            aside.unlink(missing_ok=True)
            aside.symlink_to(self.device)
            aside.replace(self.link)  # at once: a host sees the old one or the new one
        except OSError as error:
            self.unplug()
            raise TrackingError(f'the port cannot be linked at {self.link} ({error.strerror})') from None

    def unplug(self, *, reserve: bool = False) -> None:
        """Vanish: whoever has it open is hung up. `reserve`: the next device will have another name."""
        if self._old_slave >= 0:
            os.close(self._old_slave)
            self._old_slave = -1
        if not self.plugged:
            return
        with contextlib.suppress(OSError):
            if str(self.link.readlink()) == self.device:
                self.link.unlink()
        if reserve:
            self._old_slave = self._slave
        else:
            os.close(self._slave)
        os.close(self._master)
        self._master = self._slave = -1

    def read(self) -> bytes:
        """What the host has said so far."""
        try:
            return os.read(self._master, BYTES)
        except BlockingIOError:
            return b''
        except OSError as error:
            if error.errno == errno.EIO:  # nobody is there
                return b''
            raise

    def write(self, data: bytes) -> int:
        """How many bytes of it the line took; none where the host does not read."""
        try:
            return os.write(self._master, data)
        except BlockingIOError:
            return 0

    def wait(self, seconds: float, *, writable: bool = False) -> None:
        """Until the host says something, the line takes something (if asked for), or the time is over."""
        if not self.plugged:
            select.select([], [], [], seconds)
            return
        select.select([self], [self] if writable else [], [], seconds)

"""A sink on a pseudo terminal that answers by a script: enough of Z-Stack to test the host against its faults."""

import os
import select
import threading
import time
import tty

from zstack_cases import line_bytes

from wsn_tracking.zstack import commands as c
from wsn_tracking.zstack.parser import Parser

IEEE = 0x00124B00199DECC9
PATIENCE = 20.0  # s, far beyond what anything here takes


def script(state=9, product=0):
    """What a sink answers; a value is a list of what it says, or makes one of the question."""
    return {
        c.SysPing: [c.SysPingRsp(0x0179)],
        c.SysVersion: [c.SysVersionRsp(2, product, 2, 6, 3)],
        c.UtilGetDeviceInfo: [c.UtilGetDeviceInfoRsp(0, IEEE, 0, 7, state)],
        c.ZdoStartup: [c.ZdoStartupRsp(0), c.ZdoStateChangeInd(8), c.ZdoStateChangeInd(9)],
        c.AfRegister: registering(),
        c.ZdoExtNwkInfo: [c.ZdoExtNwkInfoRsp(0, 9, 0x1A62, 0, 0xDDDD, 0, 11)],
        c.ZdoExtAddGroup: [c.ZdoExtAddGroupRsp(0)],
        c.ZdoMgmtLqiReq: [c.ZdoMgmtLqiReqRsp(0)],
        c.NvWrite: [c.NvWriteRsp(0)],
        c.SysResetReq: [c.SysResetInd(0, 2, product, 2, 6, 3)],
        c.BdbSetChannel: [c.BdbSetChannelRsp(0)],
        c.BdbStartCommissioning: [c.BdbStartCommissioningRsp(0), c.ZdoStateChangeInd(9)],
        c.AfDataRequest: lambda asked: [c.AfDataRequestRsp(0), c.AfDataConfirm(0, 0xE8, asked.trans_id)],
    }


def registering():
    """A sink that has not heard of our endpoint."""
    statuses = iter((0,))
    return lambda asked: [c.AfRegisterRsp(next(statuses, 0xB8))]


class FakeSink:
    """Lives behind `link`, a stable name; `answers` may be changed at any time."""

    def __init__(self, link, answers=None):
        self.link = link
        self.answers = script() if answers is None else answers
        self.mute = False
        self.asked = []  # commands, in order
        self.other = b''  # bytes that are no frames, such as those that wake
        self._changed = threading.Condition()
        self._stop = threading.Event()
        self.plug()

    def plug(self):
        """Appear, under a name of its own each time."""
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        self.device = os.ttyname(self._slave)
        self.link.unlink(missing_ok=True)
        self.link.symlink_to(self.device)
        self._stop.clear()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def unplug(self):
        """Vanish."""
        self._stop.set()
        self._thread.join()
        os.close(self._slave)
        os.close(self._master)
        self.link.unlink()

    def close(self):
        if not self._stop.is_set():
            self.unplug()

    def say(self, *what):
        """Commands, frames or bytes, in one write."""
        os.write(self._master, b''.join(item if isinstance(item, bytes) else line_bytes(item) for item in what))

    def questions(self, kind):
        return [asked for asked in self.asked if isinstance(asked, kind)]

    def wait(self, condition):
        """Until `condition()`, judged after each question."""
        with self._changed:
            assert self._changed.wait_for(condition, PATIENCE), f'asked so far: {self.asked}'

    def wait_asked(self, kind, times=1):
        self.wait(lambda: len(self.questions(kind)) >= times)
        return self.questions(kind)[times - 1]

    def _run(self):
        parser = Parser()
        while not self._stop.is_set():
            if not select.select([self._master], [], [], 0.01)[0]:
                continue
            data = os.read(self._master, 65536)
            self.other += data.replace(b'\xfe', b'') if set(data) <= {0xEF} else b''
            for frame in parser.feed(data, time.monotonic()):
                self._take(c.decode(frame))

    def _take(self, asked):
        with self._changed:
            self.asked.append(asked)
            self._changed.notify_all()
        if self.mute:
            return
        answers = self.answers.get(type(asked), [])
        for answer in answers(asked) if callable(answers) else answers:
            self.say(answer)

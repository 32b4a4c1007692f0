"""Make the broken bags anew from bags/a_loop: each is wrong in one way, told by its name."""

from __future__ import annotations

import shutil
from pathlib import Path

from wsn_tracking.bags.messages import to_cdr
from wsn_tracking.bags.playback import playback
from wsn_tracking.bags.read import read
from wsn_tracking.bags.save import save
from wsn_tracking.bags.write import BagWriter
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.sensing.values import Request

HERE = Path(__file__).resolve().parent
EPOCHS = 20


def main() -> None:
    """Write every bag."""
    whole = read(HERE.parent / 'a_loop')
    recording = _first_epochs(whole)
    for name in ('truncated', 'wrong_type', 'out_of_order', 'no_truth', 'empty'):
        shutil.rmtree(HERE / name, ignore_errors=True)
    _truncated(whole)
    _wrong_type(recording)
    save(HERE / 'no_truth', recording._replace(truth={}))
    _out_of_order(recording)
    (HERE / 'empty').mkdir()
    (HERE / 'empty' / 'empty_0.mcap').touch()


def _first_epochs(recording: Recording) -> Recording:
    kept = tuple(m for m in recording.messages if (m.seq if isinstance(m, Request) else m.request_seq) < EPOCHS)
    return recording._replace(messages=kept)


def _out_of_order(recording: Recording) -> None:
    """The messages of every third epoch after those of the next: stamps fall back by one period."""
    epochs = [[] for _ in range(EPOCHS)]
    for event in playback(recording).events:
        epochs[event.epoch].append(event)
    for k in range(1, EPOCHS - 2, 3):
        epochs[k], epochs[k + 1] = epochs[k + 1], epochs[k]
    events = [event for epoch in epochs for event in epoch]
    start = events[0].stamp_ns
    with BagWriter(HERE / 'out_of_order', recording.metadata) as bag:
        bag.write('anchors', recording.anchors, start)
        for place, event in enumerate(events):
            bag.write(event.topic, event.value, start + place * 1_000_000)


def _truncated(recording: Recording) -> None:
    """The file of a recorder that was killed: cut in the middle, no index, no metadata.yaml."""
    save(HERE / 'truncated', recording)
    path = HERE / 'truncated' / 'truncated_0.mcap'
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    (HERE / 'truncated' / 'metadata.yaml').unlink()


def _wrong_type(recording: Recording) -> None:
    """Topic rssi holds requests."""
    with BagWriter(HERE / 'wrong_type', recording.metadata) as bag:
        bag.write('anchors', recording.anchors, playback(recording).events[0].stamp_ns)
        for event in playback(recording).events:
            if event.topic == 'request':
                bag.write('request', event.value, event.stamp_ns)
                cdr = to_cdr(event.value, event.stamp_ns)
                bag.write_raw('rssi', 'wsn_tracking_msgs/msg/LocationRequest', cdr, event.stamp_ns)


if __name__ == '__main__':
    main()

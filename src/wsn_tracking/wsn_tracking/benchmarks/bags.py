"""Bags: reading one of many ranges, against mcap with mcap-ros2-support; evaluating recordings, against real time."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np

from wsn_tracking import graphs
from wsn_tracking.bags.read import read
from wsn_tracking.bags.save import save
from wsn_tracking.benchmarks.rows import Row, Sizes, at_least, at_most, cpu_seconds
from wsn_tracking.evaluation.run import summarise
from wsn_tracking.evaluation.summary import Summary
from wsn_tracking.models.radio import range_at
from wsn_tracking.offline import offline
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.sensing.values import EpochEnd, Modality, Range, Rssi
from wsn_tracking.simulation.paths import polygon_loop
from wsn_tracking.simulation.record import record
from wsn_tracking.simulation.scenarios import scenario

GROUP = 'bags'
CORNERS = ((0.6, 0.6), (3.0, 0.6), (3.0, 1.8), (0.6, 1.8))  # of scenario L


def loop(period: float, seconds: float, seed: int = 1) -> Recording:
    """Scenario L (12 nodes, signal strengths) with another period [s], for so long."""
    times = np.arange(round(seconds / period)) * period
    walk = scenario('a_loop')._replace(period=period, truth=polygon_loop(CORNERS, 0.06, times))
    return record(walk, seed)


def as_ranges(recording: Recording) -> Recording:
    """The same where every node has sent a range."""
    rows = {node: row for row, node in enumerate(recording.anchors.ids.tolist())}

    def ranged(m: Rssi) -> Range:
        row = rows[m.node_id]
        distance = float(range_at(recording.anchors, m.rssi_dbm)[row])
        variance = (0.12 * distance) ** 2
        return Range(*m[:5], Modality.RSSI, distance, variance, m.rssi_dbm)

    messages = tuple(
        ranged(m) if isinstance(m, Rssi) else m._replace(topic='range') if isinstance(m, EpochEnd) else m
        for m in recording.messages
    )
    metadata = {**recording.metadata, 'entry_level': 'range'}
    return recording._replace(messages=messages, entry_level='range', metadata=metadata)


def read_by_mcap(bag: Path) -> list[tuple[int, float]]:
    """Node and range of every measurement, in order, by Foxglove's reader for Python; it decodes every message."""
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory

    found = []
    with next(iter(bag.glob('*.mcap'))).open('rb') as stream:
        for _, channel, _, message in make_reader(stream, decoder_factories=[DecoderFactory()]).iter_decoded_messages():
            if channel.topic.endswith('/range'):
                found.append((message.node_id, message.range))
    return found


def evaluated(bag: Path, **settings: object) -> Summary:
    """What `wsn-tracking evaluate` computes: read, three filters and their fusion, scores."""
    source, recording = graphs.open_bag(str(bag))
    run = offline(source, recording, settings=settings)
    return summarise(source.title, recording, run)


def rows(sizes: Sizes) -> Iterable[Row]:
    """Time per message, times real time, seconds for an hour."""
    with tempfile.TemporaryDirectory(prefix='wsn_tracking_') as folder:
        yield from _read_rows(Path(folder, 'ranges'), sizes)
        fast, long = Path(folder, 'ten_hertz'), Path(folder, 'hour')
        save(fast, loop(0.1, sizes.bag_s))
        save(long, loop(1.0, sizes.long_s))
        always: Callable[[], object] = lambda: evaluated(fast, **{'trigger.kind': 'always'})  # noqa: E731
        took = cpu_seconds({'fast': always, 'long': lambda: evaluated(long)}, sizes)
        work = 'evaluate, 12 nodes at 10 Hz that always send, 3 filters, CI'
        yield Row(GROUP, work, 'x real time', sizes.bag_s / took['fast'], goal=at_least(100.0))
        work = f'evaluate {sizes.long_s / 3600.0:g} h, 12 nodes at 1 Hz'
        yield Row(GROUP, work, 's', took['long'], goal=at_most(10.0 * sizes.long_s / 3600.0))


def _read_rows(bag: Path, sizes: Sizes) -> Iterable[Row]:
    recording = as_ranges(loop(0.1, 0.1 * max(sizes.messages // 12, 1)))
    save(bag, recording)
    count = len(recording.messages)
    contenders: dict[str, Callable[[], object]] = {'ours': lambda: read(bag)}
    note = ''
    try:
        read_by_mcap(bag)
        contenders['mcap'] = lambda: read_by_mcap(bag)
    except ImportError as error:
        note = f'not installed ({error.name})'
    took = {name: 1e6 * seconds / count for name, seconds in cpu_seconds(contenders, sizes).items()}
    work = f'read a bag of {sizes.messages} ranges, per message'
    yield Row(
        GROUP, work, 'us', took['ours'], 'mcap-ros2-support', took.get('mcap'), at_least(10.0, ratio=True), note=note
    )

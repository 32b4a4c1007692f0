"""What the graphs of all systems are made of: processes, what is known of their feed, who listens to them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from wsn_tracking.bags.epochs import with_epoch_ends
from wsn_tracking.bags.playback import TOPICS
from wsn_tracking.bags.read import read
from wsn_tracking.bags.types import truth_target
from wsn_tracking.configuration import Values
from wsn_tracking.errors import TrackingError
from wsn_tracking.sensing.recording import Recording

LOSS_TIMEOUT = 20.0  # [s] steady time; a feed that waits loses nothing, so this only tells a broken one


class Process(NamedTuple):
    """One process of a graph; topics are relative names."""

    executable: str
    name: str
    parameters: Mapping[str, Any]
    takes: tuple[str, ...] = ()
    gives: tuple[str, ...] = ()


class Source(NamedTuple):
    """What a graph must know of its feed."""

    title: str
    entry_level: str
    ids: tuple[int, ...]
    targets: tuple[int, ...]  # in the order of their first message
    metadata: Mapping[str, str]
    topics: tuple[str, ...]  # what the feed publishes beside the anchors

    @property
    def area(self) -> tuple[float, ...]:
        """x_min, y_min, x_max, y_max [m]; empty where the feed knows none."""
        return tuple(float(edge) for edge in self.metadata.get('area', '').split())

    def of_target(self, target_id: int) -> Source:
        """The feed of one target alone; -1: all of it."""
        if target_id < 0:
            return self
        topics = (topic for topic in self.topics if truth_target(topic) in {None, target_id})
        return self._replace(targets=(target_id,), topics=tuple(topics))


class Tracked(NamedTuple):
    """What feed and listeners must know of the nodes that track."""

    target_id: int
    outputs: tuple[str, ...]  # names of the estimates
    window: tuple[str, ...]  # those that the feed stays close to
    parameters: Values  # that one configuration gives to all
    inputs: tuple[str, ...] = ()  # what the evaluator takes besides


def open_bag(bag: str, namespace: str | None = None) -> tuple[Source, Recording]:
    """A bag with an EpochEnd for every epoch, and what a graph must know of it."""
    recording = with_epoch_ends(read(bag, namespace))
    return source_of(Path(bag).resolve().name, recording), recording


def source_of(title: str, recording: Recording) -> Source:
    """What a graph must know of a recording."""
    topics = {'request', 'epoch_end', *(TOPICS[kind] for kind in {type(m) for m in recording.messages})}
    return Source(
        title,
        recording.entry_level,
        tuple(recording.anchors.ids.tolist()),
        tuple(dict.fromkeys(m.target_id for m in recording.messages)),
        recording.metadata,
        (*sorted(topics), *(f'truth/target_{target}' for target in sorted(recording.truth))),
    )


def numbers_of(source: Source, **kept: tuple[str, float]) -> dict[str, float]:
    """Parameters from the metadata of a feed, each as its name=(key, factor)."""
    try:
        return {
            name: factor * float(source.metadata[key]) for name, (key, factor) in kept.items() if key in source.metadata
        }
    except ValueError as error:
        raise not_a_number(source, error) from error


def not_a_number(source: Source, error: ValueError) -> TrackingError:
    """What a bag is told whose metadata should be numbers."""
    return TrackingError(f'{source.title}: its metadata {dict(source.metadata)} holds no number: {error}')


def complete(
    source: Source,
    tracked: Tracked,
    tracking: Sequence[Process],
    feed: Process,
    *,
    evaluator: Values | None = None,
    record: Values | None = None,
    markers: bool = False,
) -> tuple[Process, ...]:
    """The processes that track, with their feed; evaluator, recorder and markers where asked for."""
    processes = list(tracking)
    if evaluator is not None:
        processes.append(_evaluator(source, tracked, [p.name for p in processes], evaluator))
    if record is not None:
        processes.append(_recorder(source, tracked, record))
    window = tuple(f'estimate/{output}' for output in tracked.window)
    parameters = {
        **tracked.parameters,
        **feed.parameters,
        'expected_nodes': [process.name for process in processes],
        'window_topics': list(window),
    }
    feed = feed._replace(parameters=parameters, takes=window, gives=('anchors', *source.topics))
    # who only looks on is neither waited for nor told whom to expect
    drawn = {**tracked.parameters, 'outputs': list(tracked.outputs)}
    onlookers = [Process('marker_node', 'markers', drawn)] if markers else []
    return _matched([*processes, *onlookers, feed])


def _evaluator(source: Source, tracked: Tracked, reporting: Sequence[str], values: Values) -> Process:
    return Process(
        'evaluator_node',
        'evaluator',
        {
            **tracked.parameters,
            'outputs': list(tracked.outputs),
            'title': source.title,
            'target_id': tracked.target_id,
            'expected_reports': list(reporting),
            **values,
        },
        takes=(
            'epoch_end',
            'anchors',
            *tracked.inputs,
            f'truth/target_{tracked.target_id}',
            *(f'estimate/{output}' for output in tracked.outputs),
        ),
    )


def _recorder(source: Source, tracked: Tracked, values: Values) -> Process:
    derived = [f'{kind}/{output}' for kind in ('estimate', 'odometry') for output in tracked.outputs]
    extra = tuple(topic for topic in values.get('extra_topics', derived if values.get('derived') else ()) if topic)
    metadata = [f'{key}={value}' for key, value in source.metadata.items()]
    return Process(
        'bag_recorder_node',
        'bag_recorder',
        {
            **tracked.parameters,
            'entry_level': source.entry_level,
            'targets': sorted({*source.targets, *(truth_target(topic) for topic in source.topics)} - {None}),
            'metadata': metadata or [''],
            'extra_topics': list(extra) or [''],
            **values,
        },
        takes=('anchors', *source.topics, *extra),
    )


def _matched(processes: Sequence[Process]) -> tuple[Process, ...]:
    """Tell every process how many partners each of its topics has, so that it knows when it is ready."""
    takers = Counter(topic for process in processes for topic in process.takes)
    givers = Counter(topic for process in processes for topic in process.gives)

    def counts(topics: Sequence[str], partners: Mapping[str, int]) -> list[str]:
        return [f'{topic}={partners[topic]}' for topic in topics if partners[topic]] or ['']

    return tuple(
        process._replace(
            parameters={
                **process.parameters,
                'expected_subscribers': counts(process.gives, takers),
                'expected_publishers': counts(process.takes, givers),
            }
        )
        for process in processes
    )

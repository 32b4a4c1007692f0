"""What the graphs of all systems are made of: processes, what is known of their feed, who listens to them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple, Protocol

from wsn_tracking.bags.epochs import with_epoch_ends
from wsn_tracking.bags.playback import TOPICS
from wsn_tracking.bags.read import read
from wsn_tracking.bags.types import truth_target
from wsn_tracking.errors import TrackingError
from wsn_tracking.node_parameters.feeds import RECORDER
from wsn_tracking.parameters import Values
from wsn_tracking.sensing.recording import Recording

LISTENERS = ('evaluator', 'bag_player', 'bag_recorder', 'world', 'marker')  # sections that every system may have
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

    def target(self, wanted: int) -> int:
        """The one target that is tracked: the wanted one, or by default (-1) the first.

        By name: what a node hears first depends on the order of arrival. TrackingError for one that is not there.
        """
        if wanted >= 0 and self.targets and wanted not in self.targets:
            raise TrackingError(f'{self.title} has no target {wanted}: expected one of {list(self.targets)}')
        return self.targets[0] if wanted < 0 and self.targets else wanted

    def of_target(self, target_id: int) -> Source:
        """The feed of one target alone."""
        topics = (topic for topic in self.topics if truth_target(topic) in {None, target_id})
        return self._replace(targets=(target_id,), topics=tuple(topics))


class How(NamedTuple):
    """What a graph is started for: it decides which timeouts there are.

    Player and world wait for the graph, so no timeout of a live network applies, unless `settings` say so; in replay,
    what is missing is an error. A `live` feed waits for nobody.
    """

    replay: bool = False
    live: bool = False
    settings: Values = MappingProxyType({})
    one_process_each: bool = False

    def timing(self, **patient: Any) -> dict[str, Any]:
        """Parameters of patience; `settings` come first."""
        return {name: self.settings.get(name, value) for name, value in patient.items()}


class Plan(Protocol):
    """One system on one feed."""

    @property
    def system(self) -> str:
        """Its name."""

    @property
    def outputs(self) -> Mapping[str, int]:
        """Names of the estimates in the order of the table, each with its target."""

    def window(self, how: How) -> Collection[str]:
        """Those outputs that the feed stays close to."""

    @property
    def parameters(self) -> Values:
        """What its configuration gives to those who listen as well."""

    @property
    def inputs(self) -> tuple[str, ...]:
        """What the evaluator takes besides estimates."""

    @property
    def drawn(self) -> Collection[str]:
        """Those outputs that markers show."""

    def processes(self, source: Source, how: How) -> list[Process]:
        """The processes that track."""


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


def reported(level: str) -> tuple[str, ...]:
    """What comes beside measurements of that level: reports, where nodes may have stayed silent."""
    return ('trigger_report',) if level == 'range' else ()


def targets_of(plans: Sequence[Plan]) -> tuple[int, ...]:
    """The targets that are tracked, ascending."""
    return tuple(sorted({target for plan in plans for target in plan.outputs.values() if target >= 0}))


def complete(
    source: Source,
    plans: Sequence[Plan],
    feed: Process,
    how: How,
    *,
    evaluator: Values | None = None,
    record: Values | None = None,
    markers: bool = False,
) -> tuple[Process, ...]:
    """The processes that track, with their feed; evaluator, recorder and markers where asked for."""
    processes = [process for plan in plans for process in plan.processes(source, how)]
    parameters = {name: value for plan in reversed(plans) for name, value in plan.parameters.items()}
    outputs = {name: target for plan in plans for name, target in plan.outputs.items()}
    if evaluator is not None:
        processes.append(_evaluator(source, plans, parameters, [p.name for p in processes], evaluator))
    if record is not None:
        processes.append(_recorder(source, outputs, parameters, record))
    window = {} if how.live else {f'estimate/{name}': outputs[name] for plan in plans for name in plan.window(how)}
    feed = feed._replace(
        parameters={
            **({} if how.live else parameters),  # a sink has parameters of its own; some of the same names
            **feed.parameters,
            'expected_nodes': [process.name for process in processes],
            'window_topics': [topic if target < 0 else f'{topic}={target}' for topic, target in window.items()],
        },
        takes=(*feed.takes, *window),
        gives=('anchors', *source.topics),
    )
    # who only looks on is neither waited for nor told whom to expect
    drawn = {**parameters, 'outputs': [name for plan in plans for name in plan.drawn]}
    onlookers = [Process('marker_node', 'markers', drawn)] if markers else []
    return _matched([*processes, *onlookers, feed])


def _evaluator(
    source: Source, plans: Sequence[Plan], parameters: Values, reporting: Sequence[str], values: Values
) -> Process:
    outputs = [name for plan in plans for name in plan.outputs]
    targets = targets_of(plans)
    return Process(
        'evaluator_node',
        'evaluator',
        {
            **parameters,
            'outputs': outputs,
            'title': source.title,
            **({'targets': list(targets)} if targets else {}),
            'expected_reports': list(reporting),
            **values,
        },
        takes=(
            'epoch_end',
            'anchors',
            *dict.fromkeys(topic for plan in plans for topic in plan.inputs),
            *(f'truth/target_{target}' for target in targets),
            *(f'estimate/{output}' for output in outputs),
        ),
    )


def _recorder(source: Source, outputs: Iterable[str], parameters: Values, values: Values) -> Process:
    derived = [f'{kind}/{output}' for kind in ('estimate', 'odometry') for output in outputs]
    extra = tuple(topic for topic in values.get('extra_topics', derived if values.get('derived') else ()) if topic)
    metadata = [f'{key}={value}' for key, value in source.metadata.items()]
    return Process(
        'bag_recorder_node',
        RECORDER,
        {
            **parameters,
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

"""Write a rosbag2 folder with MCAP storage, as `ros2 bag record` of Jazzy does."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import IO, TYPE_CHECKING

from mcap.writer import CompressionType, Writer

from wsn_tracking.bags.folder import (
    METADATA,
    Qos,
    TopicCount,
    default_qos,
    dump_qos,
    dump_yaml,
    information,
    metadata_yaml,
)
from wsn_tracking.bags.messages import to_cdr, type_of
from wsn_tracking.bags.types import definition, expected_type, split_topic, type_hash
from wsn_tracking.errors import TrackingError

if TYPE_CHECKING:  # typing has it from Python 3.11 on
    from typing_extensions import Self

CHUNK = 64 * 1024  # [bytes] what a killed recorder loses at most
RECORD = 'wsn_tracking'  # name of the MCAP record that holds our metadata


class BagWriter:
    """A bag in the making: a context manager, finalised in any case so that what was written is readable.

    `metadata` goes into metadata.yaml (custom_data) and into the file itself. Raises TrackingError where the
    folder exists, cannot be made or is full.
    """

    def __init__(self, path: Path | str, metadata: Mapping[str, str]) -> None:
        self.path = Path(path)
        self._metadata = {str(key): str(value) for key, value in metadata.items()}
        self._name = f'{self.path.name}_0.mcap'
        self._schemas: dict[str, int] = {}
        self._topics: dict[tuple[str, str], tuple[int, Qos]] = {}
        self._counts: dict[tuple[str, str], int] = {}
        self._span: tuple[int, int] | None = None
        self._stream: IO[bytes] | None = None
        try:
            self.path.mkdir(parents=True)
            self._stream = (self.path / self._name).open('xb')
            self._mcap = Writer(self._stream, chunk_size=CHUNK, compression=CompressionType.ZSTD)
            self._mcap.start(profile='ros2', library='wsn_tracking')
            self._mcap.add_metadata(RECORD, self._metadata)
        except FileExistsError:
            raise TrackingError(f'{self.path} exists: name another folder or remove it') from None
        except OSError as error:
            raise self._failed(error) from error

    def __enter__(self) -> Self:
        """Nothing to open: the constructor has done it."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self.close()
        except TrackingError:
            if error is None:  # else the first failure is the one to tell
                raise

    def write(self, topic: str, value: object, log_ns: int) -> None:
        """Write a value (sensing.values, Anchors, TruthPose, Estimate) at a log time [ns]."""
        type_name = type_of(value)
        expected = expected_type(split_topic(topic).name)
        if expected != type_name:
            raise TrackingError(f'topic {topic!r} was given {type_name}, expected {expected}')
        self.write_raw(topic, type_name, to_cdr(value, log_ns), log_ns)

    def write_raw(self, topic: str, type_name: str, cdr: bytes, log_ns: int, qos: Qos | None = None) -> None:
        """Write a serialised message unchanged; its type is one of ours or of ROS 2 Jazzy."""
        if self._stream is None:
            raise TrackingError(f'{self.path} is closed: nothing more can be written')
        if not 0 <= log_ns < 2**63:
            raise TrackingError(f'log time {log_ns} ns of a message on {topic!r} leaves 0..2^63-1')
        topic = '/' + topic.strip('/')
        try:
            channel = self._channel(topic, type_name, qos or default_qos(topic))
            self._mcap.add_message(channel, int(log_ns), bytes(cdr), int(log_ns))
        except OSError as error:
            raise self._failed(error) from error
        first, last = self._span or (log_ns, log_ns)
        self._span = min(first, int(log_ns)), max(last, int(log_ns))
        self._counts[topic, type_name] += 1

    def close(self) -> None:
        """Write index and metadata.yaml; a second call does nothing."""
        stream, self._stream = self._stream, None
        if stream is None:
            return
        counts = [
            TopicCount(topic, type_name, qos, self._counts[topic, type_name])
            for (topic, type_name), (_, qos) in self._topics.items()
        ]
        content = information(self._name, self._span or (0, 0), counts, self._metadata)
        try:
            try:
                with stream:
                    self._mcap.add_metadata('rosbag2', {'serialized_metadata': dump_yaml(content)})
                    self._mcap.finish()  # type: ignore[no-untyped-call]
            finally:
                (self.path / METADATA).write_text(metadata_yaml(content), 'utf-8')
        except OSError as error:
            raise self._failed(error) from error

    def _channel(self, topic: str, type_name: str, qos: Qos) -> int:
        key = (topic, type_name)
        if key not in self._topics:
            if type_name not in self._schemas:
                text = definition(type_name).encode()
                self._schemas[type_name] = self._mcap.register_schema(type_name, 'ros2msg', text)
            details = {
                'offered_qos_profiles': dump_yaml(dump_qos(qos)),
                'topic_type_hash': type_hash(type_name),
            }
            number = self._mcap.register_channel(topic, 'cdr', self._schemas[type_name], details)
            self._topics[key] = (number, qos)
            self._counts[key] = 0
        return self._topics[key][0]

    def _failed(self, error: OSError) -> TrackingError:
        return TrackingError(f'{self.path} cannot be written: {error.strerror or error}; free or name a place')

"""Short recordings that the tests of graphs, evaluation and commands share."""

from __future__ import annotations

from functools import cache

from wsn_tracking.sensing.average import one_a_node
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.sensing.stage import SensingStage, TriggerConfig
from wsn_tracking.sensing.values import Epoch, EpochEnd, Request, Rssi
from wsn_tracking.simulation.record import record
from wsn_tracking.simulation.scenarios import scenario


@cache
def a_loop(epochs: int = 120, seed: int = 0) -> Recording:
    """The first epochs of scenario a_loop."""
    s = scenario('a_loop')
    return record(s._replace(truth=s.truth[:epochs]), seed)


def ranged(recording: Recording, trigger: TriggerConfig, *, reports: bool = True) -> Recording:
    """What the sensing nodes made of a recording of signal strengths, as a recording of its own."""
    stage = SensingStage(trigger, recording.anchors)
    messages, packets = [], []
    for message in recording.messages:
        if isinstance(message, Request):
            messages.append(message)
            packets.clear()
        elif isinstance(message, Rssi):
            packets.append(message)
        elif isinstance(message, EpochEnd):
            epoch = Epoch(message.target_id, message.request_seq, message.stamp_ns, one_a_node(packets))
            sensed = stage.step(epoch)
            listed = (sensed.report.sent_ids, sensed.report.sent_seqs)
            messages += [*sensed.ranges, *([sensed.report] if reports else [])]
            messages.append(message._replace(topic='range', node_ids=listed[0], seqs=listed[1]))
    metadata = {**recording.metadata, 'entry_level': 'range'}
    return recording._replace(messages=tuple(messages), entry_level='range', metadata=metadata)


def without_truth(recording: Recording) -> Recording:
    return recording._replace(truth={})


def with_second_target(recording: Recording, target_id: int = 4) -> Recording:
    """Every epoch once more, for a target that is heard half a period later."""
    later = []
    for message in recording.messages:
        shifted = message._replace(target_id=target_id, stamp_ns=message.stamp_ns + 500_000_000)
        later.append(shifted._replace(final=False) if isinstance(shifted, EpochEnd) else shifted)
    both = sorted([*recording.messages, *later], key=lambda m: m.stamp_ns)
    return recording._replace(messages=tuple(both))

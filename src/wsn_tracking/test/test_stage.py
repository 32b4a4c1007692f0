"""What the sensing nodes send, what they keep, and why."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.models.radio import rssi_at
from wsn_tracking.sensing.stage import SensingStage, TriggerConfig
from wsn_tracking.sensing.values import Epoch, Modality, Range, Reason, Rssi

ALWAYS = TriggerConfig(kind='always')
ANCHORS = make_anchors([3, 5, 8, 9], [[0, 0, 1], [2, 0, 1], [0, 2, 1], [2, 2, 1]], n=[2.0, 3.0, 2.5, 3.0])


def epoch(k, heard, sigma=math.nan):
    """heard: dBm by node."""
    packets = tuple(Rssi(1000 * k, node, 4, 70 + k, k, dbm, sigma, 2) for node, dbm in sorted(heard.items()))
    return Epoch(4, k, 1000 * k, packets)


def reasons(sensed):
    return {node: Reason(reason) for node, reason in zip(sensed.report.silent_ids, sensed.report.reasons, strict=True)}


def test_every_silent_node_says_why():
    """The event trigger: first hearing, a change within its limits, one beyond them, none, a weak signal."""
    stage = SensingStage(TriggerConfig(alpha=0.5, e_min=0.2, e_max=0.6, y_min=-55.0), ANCHORS)
    first = stage.step(epoch(0, {3: -50.0, 5: -50.0, 8: -50.0, 9: -60.0}))
    assert first.ranges == ()
    assert reasons(first) == {
        3: Reason.UNCHANGED, 5: Reason.UNCHANGED, 8: Reason.UNCHANGED, 9: Reason.OUT_OF_RADIUS
    }  # fmt: skip
    second = stage.step(epoch(1, {3: -50.8, 5: -52.0, 9: -50.0}))
    assert [r.node_id for r in second.ranges] == [3]  # 0.5 * 0.8 dB
    assert reasons(second) == {5: Reason.NOISY, 8: Reason.NOT_HEARD, 9: Reason.NOISY}


@pytest.mark.parametrize('dbm', [127.0, -128.0, math.nan, math.inf])
def test_a_value_that_no_radio_can_say_is_invalid_and_leaves_the_trigger_as_it_was(dbm):
    """+127 and -128 are how radios spell `no value`."""
    config = TriggerConfig(alpha=0.5)
    stage, undisturbed = SensingStage(config, ANCHORS), SensingStage(config, ANCHORS)
    for one in (stage, undisturbed):
        one.step(epoch(0, {3: -50.0}))
    disturbed = stage.step(epoch(1, {3: dbm}))
    assert disturbed.ranges == ()
    assert reasons(disturbed)[3] == Reason.INVALID
    undisturbed.step(epoch(1, {}))
    assert stage.step(epoch(2, {3: -50.8})) == undisturbed.step(epoch(2, {3: -50.8}))


def test_seqs_count_what_each_node_sent():
    stage = SensingStage(ALWAYS, ANCHORS)
    seqs = {node: [] for node in (3, 5)}
    for k in range(4):
        heard = {3: -50.0, **({5: -50.0} if k % 2 else {})}
        for r in stage.step(epoch(k, heard)).ranges:
            seqs[r.node_id].append(r.seq)
    assert seqs == {3: [0, 1, 2, 3], 5: [0, 1]}
    stage.reset()
    assert [r.seq for r in stage.step(epoch(9, {3: -50.0})).ranges] == [0]


def test_a_range_is_the_distance_at_which_the_signal_is_expected():
    distances = np.array([0.7, 1.3, 2.1, 0.4])
    heard = dict(zip(ANCHORS.ids.tolist(), rssi_at(ANCHORS, distances).tolist(), strict=True))
    sensed = SensingStage(ALWAYS, ANCHORS).step(epoch(3, heard))
    assert [r.range for r in sensed.ranges] == pytest.approx(distances.tolist(), abs=1e-12)
    for r, share in zip(sensed.ranges, 1.56 * np.log(10) / 10 / ANCHORS.n, strict=True):
        assert r.variance == pytest.approx((share * r.range) ** 2)
        assert (r.stamp_ns, r.target_id, r.request_seq, r.modality, r.n_samples) == (3000, 4, 3, Modality.RSSI, 2)
        assert r.rssi_dbm == heard[r.node_id]


def test_a_packet_that_knows_its_deviation_scales_the_variance():
    known = SensingStage(ALWAYS, ANCHORS).step(epoch(0, {5: -50.0}, sigma=3.12)).ranges[0]
    table = SensingStage(ALWAYS, ANCHORS).step(epoch(0, {5: -50.0})).ranges[0]
    assert known.variance == pytest.approx(4.0 * table.variance)


def test_what_is_no_signal_strength_is_not_heard():
    stray = Range(0, 3, 4, 0, 0, Modality.UWB, 2.0)
    sensed = SensingStage(ALWAYS, ANCHORS).step(Epoch(4, 0, 0, (stray,)))
    assert set(reasons(sensed).values()) == {Reason.NOT_HEARD}


configs = st.sampled_from(
    [ALWAYS, TriggerConfig(), TriggerConfig(kind='near', y_min=-52.0), TriggerConfig(kind='random', rate=0.5)]
)
levels = st.sampled_from([-45.0, -50.0, -50.7, -51.0, -60.0, 127.0])
sequences = st.lists(st.dictionaries(st.sampled_from([3, 5, 8, 9, 77]), levels, max_size=5), min_size=1, max_size=6)


@given(configs, sequences, st.integers(0, 3))
@settings(max_examples=80)
def test_one_process_or_many_send_the_same_and_report_every_node_once(config, heard, seed):
    together = SensingStage(config, ANCHORS, seed=seed)
    apart = [SensingStage(config, ANCHORS, ids, seed) for ids in ((3,), (8, 5), (9,))]
    for k, levels_ in enumerate(heard):
        one = together.step(epoch(k, levels_))
        many = [stage.step(epoch(k, levels_)) for stage in apart]
        assert sorted(r for sensed in many for r in sensed.ranges) == list(one.ranges)
        assert sorted(pair for sensed in many for pair in reasons(sensed).items()) == sorted(reasons(one).items())
        named = [*one.report.sent_ids, *one.report.silent_ids]
        assert sorted(named) == ANCHORS.ids.tolist()
        assert one.report.sent_seqs == tuple(r.seq for r in one.ranges)
        assert one.report[:3] == (1000 * k, 4, k)


def test_a_draw_depends_on_seed_node_and_epoch_alone():
    """A lost epoch or a restart shifts nothing."""
    heard = dict.fromkeys(ANCHORS.ids.tolist(), -50.0)
    config = TriggerConfig(kind='random', rate=0.5)
    stage = SensingStage(config, ANCHORS, seed=7)
    sent = [stage.step(epoch(k, heard)).report.sent_ids for k in range(20)]
    late = SensingStage(config, ANCHORS, seed=7)
    assert [late.step(epoch(k, heard)).report.sent_ids for k in range(10, 20)] == sent[10:]
    other = SensingStage(config, ANCHORS, seed=8)
    assert [other.step(epoch(k, heard)).report.sent_ids for k in range(20)] != sent


def test_wrong_thresholds_and_unknown_nodes_are_refused():
    with pytest.raises(TrackingError, match=r'`trigger.e_max` 0.2 dB is not above `trigger.e_min` 0.2 dB'):
        TriggerConfig(e_max=0.2).strategy()
    with pytest.raises(TrackingError, match=r'nodes \[4\] are not among the anchors \[3, 5, 8, 9\]'):
        SensingStage(ALWAYS, ANCHORS, ids=[3, 4])

"""Readings of any kind become records of the air: ranges, worn nodes, recordings."""

import dataclasses
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sink_cases import QUIET, Host, epochs
from zstack_cases import properties

from wsn_tracking.airwaves import air_epochs, recording_of
from wsn_tracking.errors import TrackingError
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.sensing.values import Modality, Range, Request
from wsn_tracking.zstack.payload import Payload, PayloadType, encode_payload
from wsn_tracking.zstack.readings import AirEpoch, Reading, rssi_record
from wsn_tracking.zstack.records import RangeRecord, RssiRecord


def test_ranges_arrive_in_millimetres():
    world = [AirEpoch(float(k), 2, k, (Reading(5, range_m=1.2344 + k, sigma=0.0121),)) for k in range(3)]
    host = Host(world).run()
    records = [report.payload.records[0] for report in host.reports]
    assert [record.range_mm for record in records] == [1234, 2234, 3234]
    assert records[0] == RangeRecord(2, records[0].age_ms, 1234, 12, 0)


def test_range_that_no_record_holds_is_an_error():
    with pytest.raises(TrackingError, match='range of 70'):
        Host([AirEpoch(0.0, 1, 0, (Reading(5, range_m=70.0),))])


@pytest.mark.parametrize(
    ('payload', 'reading'),
    [('range', Reading(5, rssi_dbm=-60.0)), ('rssi', Reading(5, range_m=1.0)), ('worn', Reading(5, range_m=1.0))],
)
def test_what_was_not_measured_is_refused_before_a_host_comes(payload, reading):
    with pytest.raises(TrackingError, match=f'traffic.payload {payload}: .* choose .*auto'):
        Host([AirEpoch(0.0, 1, 0, (reading,))], traffic=dataclasses.replace(QUIET, payload=payload))


def test_worn_node_tells_of_its_references_in_several_messages():
    traffic = dataclasses.replace(QUIET, payload='worn')
    world = epochs(4, nodes=14, robot=77)
    host = Host(world, traffic=traffic).run()
    assert {r.payload.type for r in host.reports} == {PayloadType.WORN}
    assert {r.payload.node_id for r in host.reports} == {77}
    assert [len(r.payload.records) for r in host.reports] == [6, 6, 2] * 4
    heard = sorted((record.robot_id, record.beacon_seq) for r in host.reports for record in r.payload.records)
    assert heard == [(node, beacon) for node in range(1, 15) for beacon in range(4)]


@pytest.mark.parametrize('payload', ['range', 'worn'])
def test_lines_carry_signal_strengths_only(payload):
    with pytest.raises(TrackingError, match='choose znp or mt_app'):
        Host(sink_protocol='ascii', traffic=dataclasses.replace(QUIET, payload=payload))
    with pytest.raises(TrackingError, match='choose znp or mt_app'):
        Host([AirEpoch(0.0, 1, 0, (Reading(5, range_m=1.0),))], sink_protocol='ascii')


@properties
@given(st.floats(-300.0, 300.0), st.one_of(st.none(), st.floats(-1.0, 100.0)), st.integers(1, 1000))
def test_any_reading_fits_its_record(rssi, sigma, n):
    record = rssi_record(Reading(1, rssi_dbm=rssi, sigma=sigma, n_samples=n), 1, 0, 0)
    encode_payload(Payload(PayloadType.RSSI, 1, 0, 0, (record,)))
    if abs(rssi) < 127:
        assert abs(record.rssi_dbm - rssi) <= 0.5


def test_invalid_reading_says_so():
    assert rssi_record(Reading(1, rssi_dbm=math.nan), 1, 7, 9) == RssiRecord(1, 7, None, 1, None, 9)


# ---- from recordings


def recording(*messages, level='range'):
    a_loop = recording_of('a_loop', '', 0)
    return Recording(a_loop.anchors, level, tuple(messages), {}, {}, {})


def test_ranges_of_a_recording_are_read():
    world = air_epochs(
        recording(
            Request(10_000_000_000, 4, 0),
            Range(10_000_000_000, 3, 4, 0, 0, Modality.UWB, 2.5, 0.04),
            Request(10_500_000_000, 4, 1),
        )
    )
    assert world == [AirEpoch(0.0, 4, 0, (Reading(3, range_m=2.5, sigma=0.2),)), AirEpoch(0.5, 4, 1, ())]


def test_bearings_are_no_radio_messages():
    with pytest.raises(TrackingError, match='rssi or range'):
        air_epochs(recording(level='observation'))


def test_one_target_of_several_is_taken():
    assert air_epochs(recording_of('a_loop', '', 0, target_id=9)) == []
    assert len(air_epochs(recording_of('a_loop', '', 0, target_id=1))) == 120

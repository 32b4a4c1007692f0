import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st
from zstack_cases import properties, report_payload

from wsn_tracking.errors import TrackingError
from wsn_tracking.zstack.bad import Bad
from wsn_tracking.zstack.payload import Flag, Payload, PayloadType, crc16, decode_payload, encode_payload
from wsn_tracking.zstack.records import FeedbackRecord, RangeRecord, RssiRecord, SensingRecord

U8, U16, U32 = st.integers(0, 255), st.integers(0, 2**16 - 1), st.integers(0, 2**32 - 1)
AGE = st.none() | st.integers(0, 0xFFFE)
SIGMA = st.none() | st.integers(0, 254).map(lambda n: n / 16)
RSSI = st.builds(RssiRecord, U16, AGE, st.none() | st.integers(-127, 127), U8, SIGMA, U8)
CENTI = st.integers(-32768, 32767).map(lambda n: n / 100)
SPEED = st.integers(-128, 127).map(lambda n: n * 0.02)
STEP = st.integers(0, 255).map(lambda n: n / 100)
RECORDS = {
    PayloadType.RSSI: RSSI,
    PayloadType.RANGE: st.builds(RangeRecord, U16, AGE, U16, U8, U8),
    PayloadType.WORN: RSSI,
    PayloadType.FEEDBACK: st.builds(FeedbackRecord, U16, CENTI, CENTI, SPEED, SPEED),
    PayloadType.COMMAND: st.builds(SensingRecord, U16, U8, st.integers(-128, 127), STEP, STEP),
}
BATTERY = st.none() | st.integers(1, 255).map(lambda n: 20 * n)


def payloads(kind):
    records = st.lists(RECORDS[kind], max_size=8).map(tuple) if kind in RECORDS else st.just(())
    return st.builds(Payload, st.just(int(kind)), U16, U16, U32, records, U8, BATTERY)


any_payload = st.sampled_from(PayloadType).flatmap(payloads)


def sealed(body):
    return body + struct.pack('<H', crc16(body))


@properties
@given(any_payload)
def test_every_payload_survives_the_air(payload):
    data = encode_payload(payload)
    assert len(data) == 14 + 8 * len(payload.records)
    assert decode_payload(data) == payload
    assert encode_payload(decode_payload(data)) == data


@properties
@given(st.binary(max_size=120))
def test_any_bytes_are_a_payload_or_bad(data):
    found = decode_payload(data)
    assert isinstance(found, (Payload, Bad))


@pytest.mark.parametrize('n', range(9))
def test_every_flipped_bit_and_swapped_pair_is_found(n):
    data = encode_payload(report_payload()._replace(records=report_payload().records * n))
    for at in range(len(data)):
        for bit in range(8):
            broken = bytearray(data)
            broken[at] ^= 1 << bit
            assert isinstance(decode_payload(bytes(broken)), Bad)
        if at and data[at] != data[at - 1]:  # what the XOR of the frame does not see
            swapped = data[: at - 1] + data[at : at + 1] + data[at - 1 : at] + data[at + 1 :]
            assert isinstance(decode_payload(swapped), Bad)


def test_crc_is_ccitt_false():
    assert crc16(b'123456789') == 0x29B1


@pytest.mark.parametrize(
    ('data', 'reason'),
    [
        (b'', 'payload_length'),
        (bytes(13), 'payload_length'),
        (encode_payload(report_payload())[:-1], 'payload_length'),
        (encode_payload(report_payload()) + b'\x00', 'payload_length'),
        (encode_payload(report_payload())[:-2] + b'\x00\x00', 'payload_crc'),
        (sealed(b'\x21' + bytes(11)), 'payload_version'),
        (sealed(b'\x17' + bytes(11)), 'payload_type'),
        (sealed(b'\x10' + bytes(11)), 'payload_type'),
        (sealed(b'\x12' + bytes(9) + b'\x01\x00' + bytes(8)), 'payload_length'),  # heartbeat with a record
        (sealed(b'\x11' + bytes(9) + b'\x09\x00' + bytes(72)), 'payload_length'),  # nine records
    ],
)
def test_bad_payload_says_why(data, reason):
    found = decode_payload(data)
    assert found.reason == reason
    assert found.detail


def test_unknown_values_have_no_number():
    record = decode_payload(sealed(struct.pack('<BBHHIBBHHbBBB', 0x11, 0, 3, 1, 0, 1, 0, 7, 0xFFFF, -128, 0, 255, 4)))
    assert record.records == (RssiRecord(7, None, None, 0, None, 4),)
    assert record.battery_mv is None


def test_units_on_the_wire_are_those_of_the_format():
    feedback = encode_payload(Payload(PayloadType.FEEDBACK, 0, 1, 0, (FeedbackRecord(7, 1.5, -2.25, 0.5, -0.06),)))
    assert struct.unpack_from('<Hhhbb', feedback, 12) == (7, 150, -225, 25, -3)
    sensing = encode_payload(Payload(PayloadType.COMMAND, 0, 1, 0, (SensingRecord(3, 1, -90, 0.2, 2.5),)))
    assert struct.unpack_from('<HBbBBH', sensing, 12) == (3, 1, -90, 20, 250, 0)


def test_flags_are_bits():
    assert [flag.value for flag in Flag] == [1, 2, 4, 8]


@pytest.mark.parametrize(
    'payload',
    [
        Payload(7, 1, 1, 1),
        Payload(PayloadType.HEARTBEAT, 1, 1, 1, report_payload().records),
        report_payload()._replace(records=report_payload().records * 9),
        report_payload()._replace(node_id=70000),
        report_payload()._replace(type=PayloadType.RANGE),
        report_payload(rssi=200),
        Payload(PayloadType.FEEDBACK, 0, 1, 0, (FeedbackRecord(7, 400.0, 0.0, 0.0, 0.0),)),
        Payload(PayloadType.FEEDBACK, 0, 1, 0, (FeedbackRecord(7, float('nan'), 0.0, 0.0, 0.0),)),
    ],
)
def test_payload_that_does_not_fit_is_refused(payload):
    with pytest.raises(TrackingError, match=r'expected|at most'):
        encode_payload(payload)

from functools import reduce
from operator import xor

import pytest
from hypothesis import given
from hypothesis import strategies as st
from zstack_cases import BYTES, VECTORS, parse, properties

from wsn_tracking.errors import TrackingError
from wsn_tracking.zstack import commands as c
from wsn_tracking.zstack.frames import Frame, Kind, Subsystem, encode_frame, fcs
from wsn_tracking.zstack.payload import Payload, PayloadType, decode_payload
from wsn_tracking.zstack.records import RssiRecord

IEEE = 0x00124B00199DECC9
EXT_PAN = 0x00124B0002F1D414
MEANINGS = {
    'SYS_PING_SREQ': c.SysPing(),
    'SYS_PING_SRSP_doc': c.SysPingRsp(0x0011),
    'SYS_PING_SRSP_cc2531': c.SysPingRsp(0x0179),
    'SYS_VERSION_SREQ': c.SysVersion(),
    'SYS_VERSION_5': c.SysVersionRsp(2, 0, 2, 6, 3),
    'SYS_VERSION_14': c.SysVersionRsp(2, 0, 2, 6, 3, 20190425, 2, 0),
    'SYS_RESET_REQ_soft': c.SysResetReq(1),
    'SYS_RESET_IND': c.SysResetInd(0, 2, 1, 2, 7, 1),
    'NV_WRITE_STARTUP2': c.NvWrite(c.Nv.STARTUP_OPTION, 0, b'\x02'),
    'NV_WRITE_SRSP_OK': c.NvWriteRsp(0),
    'NV_WRITE_PANID': c.NvWrite(c.Nv.PANID, 0, (0x1A63).to_bytes(2, 'little')),
    'NV_READ_CFG_SRSP': c.NvReadRsp(0, b'\x55'),
    'ZDO_STARTUP_100': c.ZdoStartup(100),
    'ZDO_STARTUP_SRSP_new': c.ZdoStartupRsp(1),
    'ZDO_STATE_8': c.ZdoStateChangeInd(8),
    'BDB_START': c.BdbStartCommissioning(4),
    'BDB_START_SRSP': c.BdbStartCommissioningRsp(0),
    'UTIL_DEVINFO_SRSP': c.UtilGetDeviceInfoRsp(0, IEEE, 0, 7, 9, ()),
    'ENDDEV_ANNCE': c.ZdoEndDeviceAnnceInd(0x2F2A, 0x2F2A, 0x00124B0002F641F9, 0),
    'SRC_RTG_IND_0': c.ZdoSrcRtgInd(0x17D4, ()),
    'SRC_RTG_IND_2': c.ZdoSrcRtgInd(0xF46F, (0x9B7A, 0x5FF6)),
    'MGMT_LQI_REQ': c.ZdoMgmtLqiReq(0xE96F, 2),
    'MGMT_LQI_RSP': c.ZdoMgmtLqiRsp(
        0,
        0,
        2,
        0,
        (
            c.Neighbour(EXT_PAN, 0x0017880100DC880B, 0x228F, 0x15, 2, 1, 0x3B),
            c.Neighbour(EXT_PAN, 0x00158D0001A5A1EC, 0x3835, 0x15, 2, 1, 0x58),
        ),
    ),
    'RPC_ERR_lib': c.RpcError(1, 0xCD, 0xAB),
}
# cluster, src, lqi, timestamp, data, mac_src, radius
MESSAGES = {
    'AF_IN_1': (0x0008, 0x17D4, 55, 14398105, '087a0a000020f3', 0x17D4, 29),
    'AF_IN_2': (0x0006, 0xF46F, 118, 14478581, '08020a00001000', 0x5FF6, 27),
    'AF_IN_3': (0x0B04, 0x8814, 51, 9031974, '083d0a0b05295000', 0x8814, 29),
    'AF_IN_4': (0x0B04, 0x4C98, 63, 9042978, '082d0a0b05292e00', 0x4C98, 29),
    'AF_IN_5': (0x0400, 0x5DCC, 102, 10862816, '18fd0a000021c30b', 0xEBB5, 28),
}


@pytest.mark.parametrize('name', VECTORS)
def test_captured_frame_is_encoded_to_the_same_bytes(name):
    (frame,) = parse(BYTES[name])
    assert encode_frame(frame) == BYTES[name]
    assert encode_frame(c.encode(c.decode(frame))) == BYTES[name]


@pytest.mark.parametrize('name', MEANINGS)
def test_captured_frame_has_its_meaning(name):
    (frame,) = parse(BYTES[name])
    found = c.decode(frame)
    assert (type(found), found) == (type(MEANINGS[name]), MEANINGS[name])


@pytest.mark.parametrize('name', MESSAGES)
def test_captured_message_has_its_meaning(name):
    (frame,) = parse(BYTES[name])
    cluster, src, lqi, timestamp, data, mac_src, radius = MESSAGES[name]
    data = bytes.fromhex(data)
    assert c.decode(frame) == c.AfIncomingMsg(0, cluster, src, 1, 1, 0, lqi, 0, timestamp, 0, data, mac_src, radius)


def test_captured_message_with_a_long_payload_has_its_meaning():
    (frame,) = parse(BYTES['AF_IN_15_cc2530'])
    found = c.decode(frame)
    assert (found.lqi, len(found.data), found.src, found.radius) == (49, 42, 0xBC3F, 29)


def test_own_frames_have_their_meaning():
    (report,), (heartbeat,) = parse(BYTES['P1_one_range']), parse(BYTES['P0_heartbeat'])
    assert decode_payload(c.decode(report).data) == Payload(
        PayloadType.RSSI, 3, 1, 1000, (RssiRecord(1, 7, -60, 5, 0.5, 9),), 1, 3000
    )
    assert decode_payload(c.decode(heartbeat).data) == Payload(PayloadType.HEARTBEAT, 3, 2, 2000, (), 0, 2980)


def test_every_captured_frame_is_looked_at():
    ours = {'AF_IN_15_cc2530', 'P1_one_range', 'P0_heartbeat'}
    assert MEANINGS.keys() | MESSAGES.keys() | ours == VECTORS.keys()


@properties
@given(st.binary(max_size=256))
def test_fcs_is_the_xor_of_all_bytes(body):
    assert fcs(body) == reduce(xor, body, 0)


def test_header_names_kind_and_subsystem_and_what_answer_shares():
    question, answer = Frame(0x2102), Frame(0x6102)
    assert (question.kind, question.subsystem) == (Kind.SREQ, Subsystem.SYS)
    assert answer.kind == Kind.SRSP
    assert question.exchange == answer.exchange


def test_too_many_data_are_refused():
    assert len(encode_frame(Frame(0x4481, bytes(250)))) == 255
    with pytest.raises(TrackingError, match='251 data bytes: at most 250'):
        encode_frame(Frame(0x4481, bytes(251)))

import pytest
from hypothesis import given
from hypothesis import strategies as st
from zstack_cases import properties

from wsn_tracking.errors import TrackingError
from wsn_tracking.zstack import commands as c
from wsn_tracking.zstack.bad import Bad
from wsn_tracking.zstack.frames import Frame, Kind

SINK_KINDS = (Kind.AREQ, Kind.SRSP)
IEEE = st.integers(0, 2**64 - 1)
U8, U16, U32 = st.integers(0, 255), st.integers(0, 2**16 - 1), st.integers(0, 2**32 - 1)
SHORTS = st.lists(U16, max_size=20).map(tuple)
BLOB = st.binary(max_size=200)
NEIGHBOURS = st.lists(st.builds(c.Neighbour, IEEE, IEEE, U16, U8, U8, U8, U8), max_size=10).map(tuple)
FIELDS = {
    c.AfDataConfirm: (U8, U8, U8),
    c.AfDataRequest: (U16, U8, U8, U16, U8, U8, U8, BLOB),
    c.AfDataRequestRsp: (U8,),
    c.AfIncomingMsg: (U16, U16, U16, U8, U8, U8, U8, U8, U32, U8, BLOB, U16, U8),
    c.AfRegister: (U8, U16, U16, U8, U8, SHORTS, SHORTS),
    c.AfRegisterRsp: (U8,),
    c.BdbCommissioningNotification: (U8, U8, U8),
    c.BdbSetChannel: (U8, U32),
    c.BdbSetChannelRsp: (U8,),
    c.BdbStartCommissioning: (U8,),
    c.BdbStartCommissioningRsp: (U8,),
    c.MtAppRsp: (U8, BLOB),
    c.NvRead: (U16, U8),
    c.NvReadRsp: (U8, BLOB),
    c.NvWrite: (U16, U8, BLOB),
    c.NvWriteRsp: (U8,),
    c.RpcError: (U8, U8, U8),
    c.SysPing: (),
    c.SysPingRsp: (U16,),
    c.SysResetInd: (U8, U8, U8, U8, U8, U8),
    c.SysResetReq: (U8,),
    c.SysVersion: (),
    c.SysVersionRsp: (U8, U8, U8, U8, U8, U32, U8, U32),
    c.UtilGetDeviceInfo: (),
    c.UtilGetDeviceInfoRsp: (U8, IEEE, U16, U8, U8, SHORTS),
    c.ZdoEndDeviceAnnceInd: (U16, U16, IEEE, U8),
    c.ZdoExtAddGroup: (U8, U16, BLOB),
    c.ZdoExtAddGroupRsp: (U8,),
    c.ZdoExtNwkInfo: (),
    c.ZdoExtNwkInfoRsp: (U16, U8, U16, U16, IEEE, IEEE, U8),
    c.ZdoLeaveInd: (U16, IEEE, U8, U8, U8),
    c.ZdoMgmtLqiReq: (U16, U8),
    c.ZdoMgmtLqiReqRsp: (U8,),
    c.ZdoMgmtLqiRsp: (U16, U8, U8, U8, NEIGHBOURS),
    c.ZdoSrcRtgInd: (U16, SHORTS),
    c.ZdoStartup: (U16,),
    c.ZdoStartupRsp: (U8,),
    c.ZdoStateChangeInd: (U8,),
    c.ZdoTcDevInd: (U16, IEEE, U16),
}
any_command = st.sampled_from(list(FIELDS)).flatmap(lambda kind: st.builds(kind, *FIELDS[kind]))


def test_every_registered_command_is_tested():
    assert {entry.make for entry in c.BY_HEADER.values()} == FIELDS.keys()


@properties
@given(any_command)
def test_every_command_survives_the_wire(command):
    frame = c.encode(command)
    found = c.decode(frame)
    assert (type(found), found) == (type(command), command)
    shape = c.shape_of(frame.header)
    assert shape.low <= len(frame.data) <= shape.high


@properties
@given(st.sampled_from(sorted(c.BY_HEADER)), st.binary(max_size=250))
def test_any_data_are_a_command_or_bad(header, data):
    found = c.decode(Frame(header, data))
    if isinstance(found, Bad):
        assert found.reason == 'malformed'
    else:
        assert data.startswith(c.encode(found).data)


@properties
@given(any_command, st.integers(1, 30))
def test_missing_bytes_are_malformed_or_absent_fields(command, missing):
    frame = c.encode(command)
    found = c.decode(frame._replace(data=frame.data[:-missing]))
    assert isinstance(found, Bad) or None in found or isinstance(command, c.MtAppRsp) or not frame.data


@pytest.mark.parametrize('size', range(16))
def test_version_comes_in_four_forms(size):
    found = c.decode(Frame(0x6102, bytes(range(2, 2 + size))))
    known = sum(value is not None for value in found) if isinstance(found, c.SysVersionRsp) else 0
    assert known == (0 if size < 5 else 5 if size < 9 else 6 if size == 9 else 7 if size < 14 else 8)
    if size in {5, 9, 10, 14}:
        assert len(c.encode(found).data) == size


@pytest.mark.parametrize('form', [5, 9, 10, 14])
def test_each_form_of_version_has_a_shape(form):
    shape = c.shape_of(0x6102)
    assert shape.low <= form <= shape.high


def test_message_without_the_last_three_bytes_is_accepted():
    whole = c.AfIncomingMsg(0, 0x10, 7, 0xE8, 0xE8, 0, 99, 0, 5, 0, b'payload', 8, 28)
    old = whole._replace(mac_src=None, radius=None)
    assert len(c.encode(whole).data) == len(c.encode(old).data) + 3
    assert c.decode(c.encode(old)) == old


@pytest.mark.parametrize('tail', [b'', b'\x01', b'\x01\x02', b'\x01\x02\x03', b'\x01\x02\x03\x04\x05'])
def test_payload_of_a_message_is_taken_by_its_length(tail):
    data = c.encode(c.AfIncomingMsg(0, 0x10, 7, 0xE8, 0xE8, 0, 99, 0, 5, 0, b'payload')).data + tail
    found = c.decode(Frame(0x4481, data))
    assert found.data == b'payload'
    assert (found.mac_src, found.radius) == ((0x0201, 3) if len(tail) >= 3 else (None, None))


def test_neighbours_may_be_an_error_of_three_bytes():
    assert c.decode(Frame(0x45B1, b'\x34\x12\x81')) == c.ZdoMgmtLqiRsp(0x1234, 0x81)
    assert c.encode(c.ZdoMgmtLqiRsp(0x1234, 0x81)).data == b'\x34\x12\x81'


def test_network_info_is_24_bytes():
    assert len(c.encode(c.ZdoExtNwkInfoRsp(0, 9, 0x1A62, 0, 1, 2, 11)).data) == 24


def test_what_a_host_says_must_be_exact_and_what_a_sink_says_may_have_grown():
    assert isinstance(c.decode(Frame(0x2101, b'\x00')), Bad)
    assert c.decode(Frame(0x6101, b'\x79\x01\x00')) == c.SysPingRsp(0x179)


def test_unknown_command_is_bad_and_named_by_its_digits():
    assert c.decode(Frame(0x41FF)) == Bad('unknown_command', '41FF')
    assert c.name_of(0x41FF) == '41FF'
    assert c.shape_of(0x41FF) is not None
    assert c.shape_of(0xA1FF) is None
    assert c.shape_of(0x5F00) is None


@pytest.mark.parametrize('command', [c.SysPingRsp(1 << 16), c.ZdoSrcRtgInd(1, (1,) * 256), c.ZdoStateChangeInd(-1)])
def test_value_that_does_not_fit_is_refused(command):
    with pytest.raises(TrackingError, match='expected values that fit their fields'):
        c.encode(command)


def test_value_that_is_no_command_is_refused():
    with pytest.raises(TrackingError, match='no registered command'):
        c.encode(c.Neighbour(0, 0, 0, 0, 0, 0, 0))


def test_error_names_the_question_it_answers():
    error = c.RpcError(2, 0x25, 0x50)
    assert error.exchange == c.encode(c.ZdoExtNwkInfo()).exchange
    assert error.meaning == 'unknown command'
    assert c.RpcError(9, 0, 0).meaning == 'code 9'


def test_reset_says_why():
    causes = [c.SysResetInd(reason, 2, 0, 2, 6, 3).cause for reason in range(4)]
    assert causes == ['power-up', 'reset pin', 'watchdog', 'reason 3']


def test_neighbour_says_what_it_is():
    assert c.Neighbour(0, 0, 0, 0x15, 0, 0, 0).device_type == 'router'

"""The memory of the simulated firmware: items, keys, structs and its address."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sink_cases import BOTH, asked, by_and_by, data_of, device, frame
from zstack_cases import properties

from wsn_tracking.zstack import commands as c
from wsn_tracking.zstack.device import DEFAULT_NETWORK, IEEE
from wsn_tracking.zstack.firmware.nib import NO_NETWORK, Network, pack_nib, unpack_nib
from wsn_tracking.zstack.frames import encode_frame


def test_what_is_written_into_memory_is_read_from_it():
    sink = device()
    assert data_of(sink, 0x2113, '60 00') == bytes(2)
    assert data_of(sink, 0x2108, '60 00 00') == bytes.fromhex('02 00')
    assert data_of(sink, 0x2109, '60 00 00 01 55') == b'\x02'
    assert data_of(sink, 0x2107, '60 00 03 00 01 55') == b'\x09'
    assert data_of(sink, 0x2107, '60 00 03 00 01 77') == b'\x00'
    assert data_of(sink, 0x2108, '60 00 00') == bytes.fromhex('00 03 55 FF FF')
    assert data_of(sink, 0x211D, '60 00 01 00 02 00 66 77') == b'\x00'
    assert data_of(sink, 0x211C, '60 00 01 00') == bytes.fromhex('00 02 66 77')
    assert data_of(sink, 0x2112, '60 00 02 00') == b'\x0c'
    assert data_of(sink, 0x2112, '60 00 03 00') == b'\x00'
    assert data_of(sink, 0x2112, '60 00 03 00') == b'\x09'


@pytest.mark.parametrize(('flavour', 'status'), [('home_1_2', 2), ('zstack_3_0', 0)])
def test_keys_are_guarded_as_the_firmware_does(flavour, status):
    sink = device(flavour)
    assert data_of(sink, 0x2113, '62 00') == b'\x10\x00'
    assert data_of(sink, 0x211C, '62 00 00 00')[0] == status
    if flavour == 'home_1_2':
        assert data_of(sink, 0x2605, '62 10' + '0D' * 16) == b'\x00'
        assert data_of(sink, 0x2604, '62') == bytes.fromhex('00 62 10') + b'\x0d' * 16


@BOTH
def test_structs_have_the_lengths_by_which_hosts_tell_a_cc253x(flavour):
    sink = device(flavour)
    assert data_of(sink, 0x2113, '82 00') == b'\x15\x00'
    assert data_of(sink, 0x2113, '21 00') == b'\x6e\x00'
    assert len(data_of(sink, 0x2749, '00')) == 28


@properties
@given(
    st.integers(11, 26), st.integers(0, 0xFFFE), st.integers(0, 2**64 - 1), st.integers(0, 0xFFFF),
    st.integers(0, 2**32 - 1),
)  # fmt: skip
def test_network_survives_its_struct(channel, pan_id, ext_pan, short, channels):
    network = Network(channel, pan_id, ext_pan, short, channels)
    assert unpack_nib(pack_nib(network)) == network


def test_struct_of_no_network_is_none():
    assert unpack_nib(pack_nib(NO_NETWORK)) == NO_NETWORK
    assert unpack_nib(pack_nib(DEFAULT_NETWORK)[:-1]) == NO_NETWORK
    assert device('zstack_3_0', network=None).chip.memory.network == NO_NETWORK


def test_address_can_be_set_until_the_memory_is_cleared():
    sink = device()
    assert data_of(sink, 0x2103, '0102030405060708') == b'\x00'
    assert data_of(sink, 0x2104) == bytes.fromhex('0102030405060708')
    asked(sink, c.NvWrite(3, 0, b'\x03'))
    asked(sink, encode_frame(frame(0x4609)))
    by_and_by(sink, 1.0)
    assert data_of(sink, 0x2104, now=1.0) == IEEE.to_bytes(8, 'little')

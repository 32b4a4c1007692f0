"""What hosts ask a sink beside its network: the board, settings by other doors, addresses, the simple interface."""

import pytest
from sink_cases import MOTE, attached, by_and_by, data_of, device, frame, joined

from wsn_tracking.zstack.device import DEFAULT_KEY, DEFAULT_NETWORK, IEEE

ADDRESS = IEEE.to_bytes(8, 'little').hex()
MOTES = MOTE.ieee.to_bytes(8, 'little').hex()


def hex_of(sink, header, data='', now=0.0):
    return data_of(sink, header, data, now).hex()


@pytest.mark.parametrize(
    ('header', 'data', 'answer'),
    [
        (0x210B, '02', '06'),
        (0x210B, '04', '02'),
        (0x210D, '03 04', '0000'),
        (0x2526, '00080000 02', '00'),
        (0x2548, 'E8', '00'),
        (0x254C, '', '00'),
        (0x2741, '0500', 'ff' * 8),
        (0x2740, '0500000000000000', 'feff'),
        (0x2606, '00', '00' + '00' * 8),
        (0x2606, '01', '01' + ADDRESS),
        (0x2606, '09', '09' + '00' * 8),
    ],
)
def test_small_questions_about_the_board_are_answered(header, data, answer):
    assert hex_of(device(), header, data) == answer


def test_timer_that_is_stopped_or_started_again_expires_once_or_never():
    sink = device()
    for now in (0.0, 0.5):
        assert hex_of(sink, 0x210A, '02 E803', now) == '00'
    assert sink.advance(1.4) == []
    assert sink.advance(1.6) == [frame(0x4181, '02')]
    assert hex_of(sink, 0x210A, '02 E803', 2.0) == '00'
    assert hex_of(sink, 0x210B, '02', 2.5) == '00'
    assert sink.advance(9.0) == []


def test_pins_are_set_cleared_and_toggled():
    sink = device()
    told = [hex_of(sink, 0x210E, question) for question in ('02 05', '03 01', '04 0F', '05 00', '02 F0')]
    assert told == ['05', '04', '0b', '0b', '0b']


def test_clock_of_the_day_goes_on_from_what_it_is_told():
    sink = device()
    assert hex_of(sink, 0x2111, '', 61.0) == '3d000000 000101 0101 d007'.replace(' ', '')
    assert hex_of(sink, 0x2110, '00000000 17 3B 3B 0C 1F E907', 100.0) == '00'  # 2025-12-31 23:59:59
    told = bytes.fromhex(hex_of(sink, 0x2111, '', 101.0))
    assert told[4:].hex() == '000000' + '0101' + 'ea07'
    assert int.from_bytes(told[:4], 'little') == 26 * 365 * 86400 + 7 * 86400  # seven leap days since 2000
    assert hex_of(sink, 0x2110, '64000000 00 00 00 00 00 0000', 200.0) == '00'
    assert hex_of(sink, 0x2111, '', 200.0)[:8] == '64000000'
    assert hex_of(sink, 0x2110, '00000000 18 00 00 01 01 E907', 300.0) == '02'


def test_settings_by_the_second_door_are_those_of_memory():
    sink = device()
    first = hex_of(sink, 0x2701)
    assert first == '00' + ADDRESS + '00080000' + '621a' + '05' + DEFAULT_KEY.hex()
    key = '0f' * 16
    for header, data in ((0x2702, '3412'), (0x2703, '00800000'), (0x2704, '04'), (0x2705, key)):
        assert hex_of(sink, header, data) == '00'
    assert hex_of(sink, 0x2701) == '00' + ADDRESS + '00800000' + '3412' + '04' + key
    assert hex_of(sink, 0x2108, '83 00 00') == '0002' + '3412'


def test_addresses_are_found_both_ways():
    sink = joined()
    assert hex_of(sink, 0x2740, MOTES, 2.0) == '3e14'
    assert hex_of(sink, 0x2741, '3E14', 2.0) == MOTES
    assert hex_of(sink, 0x2741, '0000', 2.0) == ADDRESS


def test_simple_interface_starts_the_network_and_tells_of_it():
    sink = device()
    assert hex_of(sink, 0x2600) == ''
    assert frame(0x4680, '00') in by_and_by(sink, 1.0)
    assert hex_of(sink, 0x2606, '05', 1.0) == '05' + f'{DEFAULT_NETWORK.channel:02x}' + '00' * 7
    assert hex_of(sink, 0x2606, '06', 1.0) == '06' + '621a' + '00' * 6
    sink.chip.motes[MOTE.short] = MOTE
    assert hex_of(sink, 0x2607, MOTES, 2.0) == ''
    assert by_and_by(sink, 3.0) == [frame(0x4685, '01 3E14' + MOTES)]
    assert hex_of(sink, 0x2607, '00' * 8, 3.0) == ''
    assert by_and_by(sink, 4.0) == []


def test_sink_without_a_network_finds_no_others_and_one_that_is_up_does_not_look():
    sink = device()
    hex_of(sink, 0x2526, '00080000 02')
    assert by_and_by(sink, 1.0) == [frame(0x45C7, '00')]
    assert hex_of(attached(device()), 0x2526, '00080000 02', 2.0) == 'c2'


def test_network_formed_without_a_key_has_a_random_one():
    def key(seed):
        sink = device(network=None, seed=seed)
        hex_of(sink, 0x2600)
        by_and_by(sink, 1.0)
        return hex_of(sink, 0x2604, '62', 1.0)[6:]

    assert len({key(1), key(2), '00' * 16}) == 3
    assert key(1) == key(1)


def test_groups_are_counted_and_removed():
    sink = joined()
    for group in ('0100', '0200'):
        assert hex_of(sink, 0x254B, 'E8' + group + '00', 2.0) == '00'
    assert hex_of(sink, 0x254C, '', 2.0) == '02'
    assert hex_of(sink, 0x2548, 'E8', 2.0) == '00'
    assert hex_of(sink, 0x254C, '', 2.0) == '00'


def test_item_that_was_converted_stands_for_its_successor():
    """0x0024 was a rate of 16 bits; the firmware keeps one of 32 bits in 0x0035 and answers for the old one."""
    sink = device()
    assert hex_of(sink, 0x2113, '2400') == '0000'
    assert hex_of(sink, 0x2108, '2400 00') == '0002e803'
    assert hex_of(sink, 0x2107, '2400 0200 00') == '00'
    assert hex_of(sink, 0x2109, '2400 00 02 D007') == '00'
    assert hex_of(sink, 0x2108, '3500 00') == '0004d0070000'
    assert hex_of(sink, 0x2112, '2400 0200') == '00'
    assert hex_of(sink, 0x2108, '2400 00') == '0002d007'

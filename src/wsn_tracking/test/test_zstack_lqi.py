import math

import pytest
from zstack_cases import BYTES, parse

from wsn_tracking.zstack.commands import decode
from wsn_tracking.zstack.lqi import SCALES, Strength, check_scale, lqi_of, reachable, scale_words, strength_of

ALL = [(name, rssi) for name, scale in SCALES.items() for rssi in range(scale.low, scale.high + 1)]


@pytest.mark.parametrize(('name', 'rssi'), ALL)
def test_every_whole_db_comes_back(name, rssi):
    scale = SCALES[name]
    censored = -1 if rssi == scale.low else 1 if rssi == scale.high else 0
    assert strength_of(lqi_of(rssi, scale), scale) == Strength(rssi, censored)


@pytest.mark.parametrize('rssi', range(-128, 128))
def test_lqi_of_cc2530_is_the_formula_of_its_firmware(rssi):
    clipped = min(max(rssi, -87), 10)
    assert lqi_of(rssi, SCALES['cc2530']) == math.floor(255 * (clipped + 87) / 97)


@pytest.mark.parametrize('lqi', range(256))
def test_way_back_is_the_formula_of_the_design(lqi):
    assert strength_of(lqi, SCALES['cc2530']).rssi_dbm == -87 + math.ceil(lqi * 97 / 255)
    assert strength_of(lqi, SCALES['cc26x2']).rssi_dbm == -90 + math.ceil(lqi / 3)


def test_captured_link_qualities_are_the_strengths_that_were_told():
    """LQI 118 of a relay at -42 dBm, 55 at -66 dBm."""
    assert [strength_of(lqi, SCALES['cc2530']).rssi_dbm for lqi in (118, 55)] == [-42, -66]


def test_ends_are_censored():
    scale = SCALES['cc2530']
    assert (strength_of(0, scale), strength_of(255, scale)) == (Strength(-87, -1), Strength(10, 1))
    assert (lqi_of(-120, scale), lqi_of(20, scale)) == (0, 255)


@pytest.mark.parametrize(('name', 'size'), [('cc2530', 98), ('cc26x2', 86)])
def test_reachable_numbers_are_as_many_as_db(name, size):
    assert len(reachable(SCALES[name])) == size


def test_wrong_scale_shows():
    cc26x2 = [lqi_of(rssi, SCALES['cc26x2']) for rssi in range(-80, -40)]
    assert check_scale(cc26x2, SCALES['cc26x2']).unreachable == ()
    check = check_scale(cc26x2, SCALES['cc2530'])
    assert check.seen == 40
    assert check.unreachable
    assert set(check.unreachable).isdisjoint(reachable(SCALES['cc2530']))


def test_scale_is_told_with_what_to_do():
    cc26x2 = [lqi_of(rssi, SCALES['cc26x2']) for rssi in range(-80, -40)]
    assert scale_words([], 'cc2530') == 'none seen: scale cc2530 not checked'
    assert 'scale cc2530 cannot give' in scale_words(cc26x2, 'cc2530')
    assert scale_words(cc26x2, 'cc2530').endswith(' ...: set lqi_scale to cc26x2')
    assert scale_words(cc26x2, 'cc26x2') == '40 seen, all fit scale cc26x2'
    assert scale_words([105], 'cc2530') == '1 seen, all fit scale cc2530; too few to rule out cc26x2'
    assert scale_words([59], 'cc2530').endswith('cannot give 59: no known scale fits')


def test_lqis_of_a_captured_neighbour_table_are_of_no_scale():
    """59 and 88: stacks smooth them, which is why they are not taken for those of messages."""
    table = decode(parse(BYTES['MGMT_LQI_RSP'])[0])
    assert [n.lqi for n in table.neighbours] == [59, 88]
    assert not {59, 88} & (reachable(SCALES['cc2530']) | reachable(SCALES['cc26x2']))

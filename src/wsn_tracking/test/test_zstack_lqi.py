import math

import pytest

from wsn_tracking.zstack.lqi import SCALES, Strength, check_scale, lqi_of, reachable, strength_of

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


def test_captured_strengths():
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

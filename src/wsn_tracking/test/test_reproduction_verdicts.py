"""What figures amount to."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from reproduction_cases import claim, figure

from wsn_tracking.reproduction.verdicts import judged, verdict, verdicts

LEVEL = st.floats(-1e6, 1e6)
BOUND = st.none() | LEVEL


@given(LEVEL, LEVEL, BOUND, BOUND)
def test_an_interval_holds_exactly_where_all_of_it_lies_within(a, b, lowest, highest):
    low, high = sorted((a, b))
    points = [low, high, 0.5 * (low + high)]
    inside = [(lowest is None or p >= lowest) and (highest is None or p <= highest) for p in points]
    found = judged([low, high], [lowest, highest])
    assert (found == 'holds') == (inside[0] and inside[1])
    if found == 'fails':
        assert not any(inside)


@given(LEVEL, LEVEL, LEVEL, LEVEL)
def test_what_fails_cannot_hold_with_more_runs(a, b, c, d):
    """A narrower interval within a failing one fails as well; one within a holding one holds."""
    low, high = sorted((a, b))
    bounds = sorted((c, d))
    found = judged([low, high], bounds)
    if found != 'open':
        third = (high - low) / 3.0
        assert judged([low + third, high - third], bounds) == found


@pytest.mark.parametrize('interval', [[None, None], [1.0, None], [math.nan, 1.0], [0.0, math.inf], None])
def test_what_is_not_a_number_fails(interval):
    assert judged(interval, [None, None]) == 'fails'


IN, OUT, ACROSS = (0.9, 1.1), (3.0, 4.0), (0.9, 3.0)
RULE = [0.5, 2.0]


@pytest.mark.parametrize(
    ('figures', 'expected'),
    [
        ([figure(IN, shape=RULE)], 'reproduced'),
        ([figure(IN, near=RULE)], 'reproduced'),
        ([figure(IN, shape=RULE, near=RULE)], 'reproduced'),
        ([figure(OUT, shape=RULE, near=RULE)], 'not reproduced'),
        ([figure(IN, shape=RULE), figure(OUT, near=RULE)], 'in shape'),
        ([figure(IN, shape=RULE), figure(OUT, shape=RULE)], 'not reproduced'),
        ([figure(ACROSS, shape=RULE), figure(OUT, shape=RULE)], 'not reproduced'),
        ([figure(ACROSS, shape=RULE), figure(IN, near=RULE)], 'undecided'),
        ([figure(IN, shape=RULE), figure(ACROSS, near=RULE)], 'undecided'),
        ([figure(IN, shape=RULE), figure(ACROSS, near=RULE), figure(OUT, near=RULE)], 'in shape'),
        ([figure(IN)], 'undecided'),
        ([], 'undecided'),
        ([figure((None, None), shape=RULE)], 'not reproduced'),
    ],
)
def test_a_claim_of_a_document_is_as_good_as_its_rules(figures, expected):
    assert verdict(claim(*figures)) == expected
    assert verdict(claim(*reversed(figures))) == expected


def test_what_only_its_shape_could_be_found_of_is_never_called_reproduced():
    assert verdict(claim(figure(IN, shape=RULE), in_kind=True)) == 'in shape'
    assert verdict(claim(figure(OUT, shape=RULE), in_kind=True)) == 'not reproduced'


def test_what_cannot_be_reproduced_is_called_so_whatever_was_measured():
    for interval in (IN, OUT, ACROSS):
        assert verdict(claim(figure(interval, shape=RULE), impossible='no data')) == 'not reproducible'


@pytest.mark.parametrize(
    ('figures', 'expected'),
    [
        ([figure(IN, shape=RULE)], 'holds'),
        ([figure(IN, shape=RULE), figure(OUT, shape=RULE)], 'does not hold'),
        ([figure(IN, shape=RULE), figure(ACROSS, shape=RULE)], 'undecided'),
        ([figure(IN)], 'undecided'),
    ],
)
def test_a_claim_of_this_project_holds_or_does_not(figures, expected):
    assert verdict(claim(*figures, kind='beyond')) == expected


def test_every_claim_gets_its_verdict_by_id():
    content = {'claims': [claim(figure(IN, shape=RULE)), {**claim(figure(OUT, shape=RULE)), 'id': 'X2'}]}
    assert verdicts(content) == {'X1': 'reproduced', 'X2': 'not reproduced'}

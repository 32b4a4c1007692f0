"""Figures as intervals: what is drawn is what the JSON says, and its colours are its verdicts."""

import pytest
from reproduction_cases import claim, figure

from wsn_tracking.reproduction import forest as forests
from wsn_tracking.reproduction.forest import FAILS, HOLDS, MOST, OPEN, forest, shown

IN, OUT, ACROSS = (0.9, 1.1), (3.0, 4.0), (0.9, 3.0)
RULE = [0.5, 2.0]


def named(name, *arguments, unit='', document=None, **rules):
    return {**figure(*arguments, **rules), 'name': name, 'unit': unit, 'document': document}


@pytest.fixture
def axes(monkeypatch):
    """The panels of a claim before they become a file."""
    monkeypatch.setattr(forests, 'as_svg', lambda drawn: drawn)
    return lambda *figures: forest(claim(*figures)).axes


def lines(panel):
    """Ends of the intervals, and what stands alone, by place."""
    drawn = [(list(map(float, line.get_xdata())), float(line.get_ydata()[0])) for line in panel.lines]
    return {y: [x for x, at in drawn if at == y] for y in {at for _, at in drawn}}


def test_intervals_values_and_documents_stand_where_they_are(axes):
    (panel,) = axes(named('a', IN, shape=RULE, document=1.5), named('b', OUT))
    assert lines(panel) == {0: [[0.9, 1.1], [1.0], [1.5]], 1: [[3.0, 4.0], [3.5]]}
    assert [label.get_text() for label in panel.get_yticklabels()] == ['a', 'b']


def test_rules_reach_as_far_as_they_allow(axes):
    (panel,) = axes(named('a', IN, shape=[0.5, None], near=[0.8, 1.2]), named('b', IN, shape=[None, 2.0]))
    low, high = panel.get_xlim()
    bands = [(min(x), max(x)) for x in (c.get_paths()[0].vertices[:, 0] for c in panel.collections)]
    assert bands == [(0.5, high), (0.8, 1.2), (low, 2.0)]


def test_all_that_is_drawn_is_within_the_axis(axes):
    (panel,) = axes(named('a', (1.0, 2.0), shape=[100.0, None]), named('b', (1000.0, 2000.0), document=0.5))
    low, high = panel.get_xlim()
    assert panel.get_xscale() == 'log'
    assert 0.0 < low < 0.5
    assert high > 2000.0


def test_one_exact_number_has_room(axes):
    for value in (0.0, 5.0, -3.0):
        (panel,) = axes(named('a', (value, value)))
        assert panel.get_xlim()[0] < value < panel.get_xlim()[1]
        assert panel.get_xscale() == 'linear'


def test_units_have_axes_of_their_own(axes):
    first, second = axes(named('a', IN, unit='m'), named('b', OUT, unit='%'), named('c', IN, unit='m'))
    assert [first.get_xlabel(), second.get_xlabel()] == ['m', '%']
    assert len(lines(first)) == 2


@pytest.mark.parametrize(
    ('interval', 'rules', 'colour'),
    [
        (IN, {'shape': RULE}, HOLDS),
        (IN, {}, HOLDS),
        (ACROSS, {'shape': RULE}, OPEN),
        (OUT, {'shape': RULE}, FAILS),
        (OUT, {'shape': [0.0, 9.0], 'near': RULE}, FAILS),
    ],
)
def test_a_colour_tells_what_becomes_of_the_rules(axes, interval, rules, colour):
    (panel,) = axes(named('a', interval, **rules))
    assert {line.get_color() for line in panel.lines} == {colour}
    legend = [text.get_text() for text in panel.figure.legends[0].get_texts()]
    assert ('outside of a rule' in legend) == (colour == FAILS)
    assert ('undecided' in legend) == (colour == OPEN)


def test_of_many_figures_those_are_drawn_that_can_be_compared():
    plain = [named(f'{i}', IN) for i in range(MOST)]
    ruled = [named('ruled', IN, shape=RULE), named('told', IN, document=1.0), named('word', IN, document='all')]
    assert shown(plain) == plain
    assert [f['name'] for f in shown([*plain, *ruled])] == ['ruled', 'told']
    assert len(shown([named(f'{i}', IN, near=RULE) for i in range(2 * MOST)])) == MOST


def test_what_is_not_a_number_is_not_drawn():
    assert shown([figure((None, None), shape=RULE)]) == []


def test_equal_claims_give_equal_files():
    told = claim(named('a name that is long enough to be told in two lines', IN, shape=RULE))
    assert (drawn := forest(told)) == forest(told)
    assert b'told in two lines' in drawn

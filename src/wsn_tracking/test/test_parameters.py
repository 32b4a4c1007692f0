"""A wrong value is refused with what was seen and what was expected."""

from __future__ import annotations

import array
import math
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from wsn_tracking.errors import TrackingError
from wsn_tracking.node_parameters.common import NodeConfig
from wsn_tracking.node_parameters.executables import EXECUTABLES
from wsn_tracking.parameters import build, check, group, param, specs


@dataclass(frozen=True)
class Inner:
    share: float = param(0.5, 'how much', '', 0.0, 1.0)
    kind: str = param('a', 'which', choices=('a', 'b'))


@dataclass(frozen=True)
class Outer:
    count: int = param(3, 'how many', 'id', 0, 10)
    on: bool = param(False, 'whether')
    name: str = param('x', 'what it is called')
    ids: tuple[int, ...] = param((), 'which of them', 'id', 0, 10)
    edges: tuple[float, ...] = param((), 'where it ends', 'm')
    words: tuple[str, ...] = param(('',), 'what is said')
    speed: float = param(1.0, 'how fast', 'm/s', low=1e-3)
    inner: Inner = group(Inner)


SPECS = {spec.name: spec for spec in specs(Outer)}


def test_leaves_are_dotted():
    assert list(SPECS) == ['count', 'on', 'name', 'ids', 'edges', 'words', 'speed', 'inner.share', 'inner.kind']


@pytest.mark.parametrize(
    ('name', 'expected'),
    [
        ('count', 'an integer >= 0 and <= 10 [id]'),
        ('on', 'true or false'),
        ('name', 'a text'),
        ('ids', 'a list of integers >= 0 and <= 10 [id]'),
        ('edges', 'a list of numbers [m]'),
        ('words', 'a list of texts'),
        ('speed', 'a number >= 0.001 [m/s]'),
        ('inner.kind', 'one of a, b'),
    ],
)
def test_what_is_expected_is_said_in_words(name, expected):
    assert SPECS[name].expected == expected


WRONG = {
    'count': [1.5, 2.0, True, '3', None, [1], -1, 11, 2**63, -(2**70), 10**5000],
    'on': [0, 1, 'true', None, []],
    'name': [1, None, True, ['x']],
    'ids': [3, '12', None, [1.5], [True], ['1'], [11], [-1], [[1]], {1: 2}, np.float64(3.0), np.array(3)],
    'edges': [1.0, [math.nan], [math.inf], ['a'], [None], [True], 'ab', [10**400]],
    'words': ['one', [1], [None]],
    'speed': [0.0, -1.0, math.nan, math.inf, -math.inf, True, '1.0', 10**400, [1.0], 2**5000],
    'inner.share': [1.0000001, -1e-9, 2],
    'inner.kind': ['c', '', 'A', 1, None],
}


@pytest.mark.parametrize(('name', 'k'), [(name, k) for name, values in WRONG.items() for k in range(len(values))])
def test_a_wrong_value_is_refused_with_name_value_and_expectation(name, k):
    value = WRONG[name][k]
    with pytest.raises(TrackingError) as error:
        build(Outer, {name: value})
    said = str(error.value)
    assert said.startswith(f'parameter `{name}` is ')
    assert said.endswith(f': expected {SPECS[name].expected} ({SPECS[name].why})')
    assert len(said) < 300
    assert '\n' not in said
    if k != WRONG['count'].index(10**5000) or name != 'count':  # Python would not write that one
        assert repr(value)[:100] in said


def test_a_long_value_is_shortened():
    with pytest.raises(TrackingError, match=r'is \[1, 2, .{80,100}\.\.\.: expected'):
        build(Outer, {'ids': list(range(1, 5000))})


@pytest.mark.parametrize(
    ('name', 'value', 'built'),
    [
        ('speed', 2, 2.0),
        ('speed', 1e300, 1e300),
        ('edges', [1, 2.5], (1.0, 2.5)),
        ('edges', array.array('d', [1.0, 2.0]), (1.0, 2.0)),
        ('ids', array.array('q', [1, 2]), (1, 2)),
        ('ids', np.array([1, 2]), (1, 2)),
        ('ids', (), ()),
        ('words', ['a', ''], ('a', '')),
        ('count', 10, 10),
        ('inner.share', 1, 1.0),
    ],
)
def test_a_right_value_has_the_type_of_the_default(name, value, built):
    seen = check(SPECS[name], value)
    assert seen == built
    assert type(seen) is type(built)
    if isinstance(built, tuple):
        assert [type(item) for item in seen] == [type(item) for item in built]


def test_what_is_absent_keeps_its_default_and_what_is_foreign_is_ignored():
    assert build(Outer, {}) == Outer()
    foreign = {'inner': 'foreign', 'share': 'foreign', 'inner.share.x': 1, 'other': None}
    built = build(Outer, {'inner.share': 0.25, **foreign})
    assert built == Outer(inner=Inner(share=0.25))


@pytest.mark.parametrize('kind', [*EXECUTABLES.values(), NodeConfig])
def test_every_default_of_every_executable_is_a_right_value(kind):
    """And says what it is for."""
    for spec in specs(kind):
        assert check(spec, spec.default) == spec.default
        assert len(spec.why) > 5
        assert spec.expected
    assert build(kind, {spec.name: spec.default for spec in specs(kind)}) == kind()


junk = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text('ab1.-', max_size=3) | st.just(b'a'),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.integers(), inner, max_size=2),
    max_leaves=4,
)


@given(st.dictionaries(st.sampled_from(sorted(SPECS)), junk, max_size=3))
def test_any_value_is_accepted_or_refused_with_our_error(values):
    built, said = None, ''
    try:
        built = build(Outer, values)
    except TrackingError as error:
        said = str(error)
    if built is None:
        assert any(f'`{name}`' in said for name in values)
    else:
        assert 0 <= built.count <= 10
        assert all(math.isfinite(edge) for edge in built.edges)

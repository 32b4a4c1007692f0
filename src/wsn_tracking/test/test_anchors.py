"""The table of anchors: ascending ids, columns that go with them, refusals."""

import numpy as np
import pytest
from oracles import small_anchors

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import Anchors, check, make_anchors


def test_rows_ascend_by_id_with_their_columns():
    anchors = small_anchors(n=[7.0, 3.0, 5.0])
    assert anchors.ids.tolist() == [3, 5, 7]
    assert anchors.n.tolist() == [3.0, 5.0, 7.0]
    assert anchors.positions[:, 2].tolist() == [0.5, 0.0, 1.0]
    assert anchors.rows([7, 4, 3, 900]).tolist() == [2, -1, 0, -1]
    assert anchors.rows([]).tolist() == []
    nobody = Anchors._make(column[:0] for column in anchors)
    assert nobody.rows([3]).tolist() == [-1]


def test_flat_positions_lie_on_the_floor():
    assert make_anchors([1, 2], [[1.0, 2.0], [3.0, 4.0]]).positions[:, 2].tolist() == [0.0, 0.0]


def test_select_keeps_some_nodes_and_refuses_unknown_ones():
    anchors = small_anchors(sigma_db=[1.0, 2.0, 3.0])
    some = anchors.select([7, 3])
    assert some.ids.tolist() == [3, 7]
    assert some.sigma_db.tolist() == [2.0, 1.0]
    with pytest.raises(TrackingError, match=r'nodes \[4\] are not among the anchors \[3, 5, 7\]'):
        anchors.select([3, 4])


@pytest.mark.parametrize(
    ('change', 'message'),
    [
        ({'ids': np.array([1, 2, 2])}, r'ids \[2\] occur more than once'),
        ({'ids': np.array([-1, 2, 3])}, r'leave 0\.\.65535'),
        ({'ids': np.array([1, 2, 65536])}, r'leave 0\.\.65535'),
        ({'positions': np.zeros((3, 2))}, r'shape \(3, 2\), expected \(N, 3\)'),
        ({'bias': np.array([0.0, np.nan, 0.0])}, '`bias` holds NaN or infinity'),
        ({'n': np.array([3.0, 0.0, 3.0])}, r'`n` holds 0\.0: expected 0\.01 to 20'),
        ({'p1_dbm': np.array([-40.0, 1e300, -40.0])}, '`p1_dbm` holds 1e\\+300: expected -200 to 100'),
        ({'positions': np.full((3, 3), -2e8)}, r'positions go up to 2e\+08 m: expected 1e\+08 m at most'),
        ({'sigma_db': np.array([-1.0, 1.0, 1.0])}, '`sigma_db` holds -1.0'),
        ({'d0': np.array([1.0, 1.0, np.inf])}, '`d0` holds NaN or infinity'),
        ({'scale': np.array([1.0, 0.0, 1.0])}, '`scale` holds 0.0'),
    ],
)
def test_a_table_that_no_filter_may_use_is_refused(change, message):
    with pytest.raises(TrackingError, match=message):
        check(small_anchors()._replace(**change))


def test_an_empty_table_and_an_unknown_column_are_refused():
    with pytest.raises(TrackingError, match='the anchors hold no node'):
        make_anchors([], np.zeros((0, 3)))
    with pytest.raises(TrackingError, match='the anchors hold no node'):
        check(Anchors._make(column[:0] for column in small_anchors()))
    with pytest.raises(TypeError, match='power'):
        make_anchors([1], [[0.0, 0.0]], power=3.0)


@pytest.mark.parametrize('positions', [np.zeros((2, 3)), np.zeros((3, 4)), np.zeros(6)])
def test_positions_of_another_number_of_nodes_are_refused(positions):
    with pytest.raises(TrackingError, match='3 anchors have positions of shape'):
        make_anchors([1, 2, 3], positions)

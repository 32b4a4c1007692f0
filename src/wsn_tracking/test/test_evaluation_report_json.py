import json
from pathlib import Path

import pytest
from evaluation_cases import a_summary

from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation.report_json import to_json, to_text, write_json

PROMISED = {'rmse_m', 'median_m', 'p95_m', 'ei_m', 'nees', 'nees_interval', 'epochs'}


def test_one_bag_has_outputs_by_name_and_input_by_reason():
    summary = a_summary()
    report = to_json(summary)
    assert list(report['outputs']) == ['local_1', 'fused_1', 'mean']
    assert set(report['outputs']['fused_1']) >= PROMISED
    assert report['outputs']['fused_1']['rmse_m'] == summary.outputs['fused_1'].rmse_m
    assert report['input'] == {'duplicate': 3, 'late': 2, 'other_target': 0}
    assert report['measurements']['sent_share'] == 0.41
    assert to_json([summary]) == report


def test_several_bags_are_listed_and_pooled():
    bags = [a_summary(1, 'first'), a_summary(9, 'second')]
    report = to_json(bags)
    assert list(report) == ['bags', 'pooled']
    assert [bag['title'] for bag in report['bags']] == ['first', 'second']
    pooled = report['pooled']['outputs']['local_1']
    squares = sum(bag['outputs']['local_1']['rmse_m'] ** 2 for bag in report['bags'])
    assert pooled['epochs'] == sum(bag['outputs']['local_1']['epochs'] for bag in report['bags'])
    assert pooled['rmse_m'] == pytest.approx((squares / 2) ** 0.5)
    assert pooled['runs'] == 2


def test_what_is_not_known_is_null_and_the_text_is_strict_json():
    report = json.loads(to_text(a_summary()), parse_constant=pytest.fail)
    assert report['outputs']['mean']['nees'] is None
    assert report['outputs']['mean']['nees_interval'] == [None, None]
    assert to_json(a_summary(skip_s=float('inf')))['skip_s'] is None


def test_equal_summaries_give_equal_text_whatever_the_order_of_the_counts():
    swapped = a_summary(input={'other_target': 0, 'duplicate': 3, 'late': 2})
    assert to_text(swapped) == to_text(a_summary())
    assert to_text(a_summary()).endswith('}\n')


def test_written_file_reads_back_and_nothing_is_left_beside_it(tmp_path):
    path = tmp_path / 'new' / 'report.json'
    write_json(path, a_summary())
    write_json(path, a_summary(2))
    assert json.loads(path.read_text()) == to_json(a_summary(2))
    assert list(path.parent.iterdir()) == [path]


def test_a_link_stays_a_link(tmp_path):
    real, link = tmp_path / 'real.json', tmp_path / 'link.json'
    link.symlink_to(real)
    write_json(link, a_summary())
    assert link.is_symlink()
    assert json.loads(real.read_text()) == to_json(a_summary())


def test_an_unwritable_path_is_one_error_and_leaves_what_was_there(tmp_path):
    (tmp_path / 'file').write_text('kept')
    with pytest.raises(TrackingError, match=r'report\.json cannot be written'):
        write_json(tmp_path / 'file' / 'report.json', a_summary())
    with pytest.raises(TrackingError, match='cannot be written'):
        write_json(tmp_path, a_summary())
    assert list(tmp_path.iterdir()) == [tmp_path / 'file']
    assert (tmp_path / 'file').read_text() == 'kept'


def test_a_device_is_written_directly():
    write_json('/dev/null', a_summary())
    assert Path('/dev/null').is_char_device()

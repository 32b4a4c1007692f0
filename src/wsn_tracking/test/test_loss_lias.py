"""System E on real ranges that get lost (data/lias_uwb_planar): the goals of issue 7, through the product's tracker."""

from __future__ import annotations

import json
from types import SimpleNamespace

import pytest
from import_cases import real_data

from wsn_tracking.models.links import Loss
from wsn_tracking.simulation.e_loss import LossConfig, e_loss
from wsn_tracking.simulation.record import record
from wsn_tracking.studies.real_radio import lost
from wsn_tracking.studies.real_radio.sets import Bags, Sets


@pytest.fixture(scope='module')
def scores(tmp_path_factory):
    """By rate; the calibration knows the first 15 s alone, which are not scored."""
    bags = Sets(real_data('lias_uwb_planar').parent, tmp_path_factory.mktemp('real')).bags('lias')
    return {p: lost.scored(bags, Loss(p), {'channel': bags.channel}, seeds=(1,)) for p in (0.0, 0.5, 0.9)}


def test_nine_of_ten_ranges_lost_cost_at_most_sixty_percent(scores):
    """Over five draws of the losses the ratio lies between 1.2 and 1.4."""
    assert scores[0.5].rmse_m < 1.2 * scores[0.0].rmse_m
    assert scores[0.9].rmse_m < 1.6 * scores[0.0].rmse_m
    assert scores[0.0].rmse_m < 0.06


def test_every_epoch_is_tracked_and_the_error_is_known(scores):
    assert all(s.nees < 4.0 for s in scores.values())
    assert {s.epochs for s in scores.values()} == {scores[0.0].epochs}


def test_the_table_is_plain_json_and_holds_every_filter_and_kind(monkeypatch):
    """On a simulated set of 20 epochs in the place of the real one."""
    monkeypatch.setattr(lost, 'SEEDS', (1,))
    simulated = record(e_loss(LossConfig(epochs=20, loss=0.0)), 1)
    area = tuple(float(edge) for edge in simulated.metadata['area'].split())
    source = SimpleNamespace(area=area, metadata=simulated.metadata)
    held = SimpleNamespace(bags=lambda name: Bags([(source, simulated)], 5.0, '', ''))
    result = lost.lias_lost(held)
    assert result == json.loads(json.dumps(result, allow_nan=False))
    kinds = {*lost.FILTERS, 'ckf_uncalibrated'}
    assert {*result['loss_0']} == kinds
    assert {*result['loss_0.9']} == {*kinds, 'ckf_rounds', 'ckf_bursts_of_20'}
    assert result['rmse_at_90_percent_of_that_at_0'] > 1.0

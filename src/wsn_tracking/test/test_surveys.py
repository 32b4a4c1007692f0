"""Surveys are known by their files, and the real one is predicted better by a map."""

from __future__ import annotations

import re
from pathlib import Path

import danis_cases as danis
import kolakowski_cases as kolakowski
import numpy as np
import pytest
from import_cases import folder, real_data

from wsn_tracking.bags.save import save
from wsn_tracking.errors import TrackingError
from wsn_tracking.sensing.channel_fit import fit_path_loss
from wsn_tracking.simulation.record import record
from wsn_tracking.simulation.scenarios import scenario
from wsn_tracking.surveys import open_survey


def test_a_bag_without_truth_or_a_folder_of_nothing_is_refused(tmp_path):
    recording = record(scenario('a_loop'), 3)
    save(tmp_path / 'blind', recording._replace(truth={}))
    with pytest.raises(TrackingError, match='holds no truth'):
        open_survey(tmp_path / 'blind')
    (tmp_path / 'nothing').mkdir()
    with pytest.raises(TrackingError, match='neither a bag'):
        open_survey(tmp_path / 'nothing')
    with pytest.raises(TrackingError, match='does not exist'):
        open_survey(tmp_path / 'absent')


def test_surveys_are_known_by_their_files(tmp_path):
    survey = open_survey(danis.flat(tmp_path / 'danis')).survey
    assert survey.ids.tolist() == [10, 11, 20]
    assert survey.points.shape == (25, 2)
    loss, _, _ = fit_path_loss(survey)
    np.testing.assert_allclose(loss.p1_dbm.value, danis.P1, atol=0.3)
    np.testing.assert_allclose(loss.n.value, danis.EXPONENT, atol=0.05)
    np.testing.assert_allclose(loss.sigma_db.value, danis.WITHIN, atol=0.2)
    assert loss.readings.tolist() == [0, 0, 0]  # histograms do not tell
    loss, _, _ = fit_path_loss(open_survey(folder(tmp_path / 'kolakowski', kolakowski.files())).survey)
    np.testing.assert_allclose(loss.p1_dbm.value, kolakowski.P1, atol=0.5)
    np.testing.assert_allclose(loss.n.value, kolakowski.EXPONENT, atol=0.1)
    with pytest.raises(TrackingError, match='leave out --until'):
        open_survey(tmp_path / 'danis', 5.0)


def figures(text):
    return [float(x) for x in re.findall(r'(\d+\.\d+) dB', text)]


@pytest.mark.parametrize(('name', 'data'), [('danis', 'danis_ble_tracks'), ('kolakowski', 'kolakowski_flat_ble')])
def test_a_real_survey_is_predicted_better_by_the_map_by_as_much_as_the_page_says(name, data):
    told = fit_path_loss(open_survey(real_data(data)).survey)[2]['left_out']
    line, mapped = figures(told)
    page = (Path(__file__).resolve().parents[3] / 'docs' / 'calibration.md').read_text('utf-8')
    (row,) = re.findall(rf'^\| {name}, places left out .*$', page, re.MULTILINE)
    assert mapped < line
    assert [line, mapped] == pytest.approx(figures(row), abs=0.011)  # both are rounded

import io
import re
import subprocess
import sys

import numpy as np
import pytest
from evaluation_cases import a_summary, line_truth, noisy_track, track
from hypothesis import given
from hypothesis import strategies as st

from wsn_tracking.evaluation.score import score
from wsn_tracking.evaluation.summary import Traffic
from wsn_tracking.evaluation.table import format_table, format_tables, nees_verdict, number, wants_colour


class Terminal(io.StringIO):
    def isatty(self):
        return True


def row(text, name):
    return next(line for line in text.splitlines() if line.startswith(name))


def test_every_output_has_its_row_of_numbers():
    summary = a_summary()
    text = format_table(summary)
    for name, result in summary.outputs.items():
        cells = row(text, name).split()
        expected = (result.rmse_m, result.median_m, result.p95_m, result.ei_m, *result.esi_m)
        assert cells[1:7] == [number(value) for value in expected]
        assert cells[-1] == str(result.epochs)


def test_an_unknown_nees_is_a_dash():
    text = format_table(a_summary())
    assert row(text, 'mean').split()[7:] == ['-', '-', '25']
    assert 'nan' not in text.lower()


def test_input_lines_name_reasons_and_leave_out_what_never_happened():
    text = format_table(a_summary())
    assert row(text, 'dropped').split(None, 1)[1] == 'duplicate 3, late 2'
    assert row(text, 'sent').split(None, 1)[1] == '41 of 100 in radius (41.0 %), of 164 received (25.0 %)'
    assert row(format_table(a_summary(input={'late': 0})), 'dropped').split() == ['dropped', 'nothing']


@pytest.mark.parametrize(
    ('traffic', 'told'),
    [
        (Traffic(), 'no trigger report'),
        (Traffic(4, 4, 4, 9), '4; the motes themselves held 9 back'),
        (Traffic(0, 0, 12), '0 of 0 in radius, of 12 received (0.0 %)'),
    ],
)
def test_sent_line_tells_unusual_traffic_too(traffic, told):
    assert told in row(format_table(a_summary(traffic=traffic)), 'sent')


def test_what_could_not_be_scored_is_told():
    truth, estimates = noisy_track()
    estimates[30] = estimates[30]._replace(covariance=np.zeros((4, 4)))
    estimates[40] = estimates[40]._replace(mean=np.full(4, np.nan))
    text = format_table(a_summary()._replace(outputs={'human': score(estimates, truth)}))
    assert row(text, 'not scored').split(None, 2)[2] == 'human: not finite 1, covariance singular 1'
    assert 'not scored' not in format_table(a_summary())


def test_a_run_without_any_scored_epoch_is_a_row_of_dashes():
    truth, estimates = noisy_track()
    text = format_table(a_summary()._replace(outputs={'human': score(estimates, truth, 1e6)}))
    assert row(text, 'human').split() == ['human', *['-'] * 8, '0']


def test_no_output_is_said():
    assert 'no output' in format_table(a_summary()._replace(outputs={}))


@given(
    st.lists(st.text('abcdefgh_123', min_size=1, max_size=120), min_size=1, max_size=4, unique=True),
    st.floats(1e-6, 1e12),
    st.text(st.characters(codec='ascii', exclude_categories=['C']), max_size=150),
)
def test_no_line_is_wider_than_a_hundred_columns(names, scale, title):
    truth = line_truth()
    result = score(track(truth, np.full((30, 2), scale) * np.arange(30)[:, None] / 7, np.eye(2)), truth)
    summary = a_summary(title=title, outputs=())._replace(
        outputs=dict.fromkeys(names, result), input={f'reason_{i}': 10**i for i in range(15)}
    )
    text = format_table(summary)
    assert text.isascii()
    assert max(map(len, text.splitlines())) <= 100
    assert not any(line.endswith(' ') for line in text.splitlines()[1:])


@given(st.floats(-1e15, 1e15))
def test_numbers_are_short_and_near(value):
    text = number(value)
    assert len(text) <= 8
    assert float(text) == pytest.approx(value, rel=0.05, abs=0.0005001)


def test_colour_changes_no_character():
    summary = a_summary()
    plain, painted = format_table(summary), format_table(summary, colour=True)
    assert '\x1b[' not in plain
    assert re.sub(r'\x1b\[\d+m', '', painted) == plain
    assert '\x1b[32m' in painted


def test_colour_only_on_a_terminal_that_wants_it(monkeypatch):
    monkeypatch.setenv('TERM', 'xterm')
    monkeypatch.delenv('NO_COLOR', raising=False)
    assert wants_colour(Terminal())
    assert not wants_colour(io.StringIO())
    monkeypatch.setenv('NO_COLOR', '1')
    assert not wants_colour(Terminal())
    monkeypatch.delenv('NO_COLOR')
    monkeypatch.setenv('TERM', 'dumb')
    assert not wants_colour(Terminal())


@pytest.mark.parametrize(('claimed', 'verdict'), [(1.0, 'ok'), (0.3, 'high'), (4.0, 'low')])
def test_the_verdict_on_a_filter_that_claims_too_much_or_too_little(claimed, verdict):
    truth, estimates = noisy_track(epochs=200)
    scaled = [e._replace(covariance=claimed * e.covariance) for e in estimates]
    assert nees_verdict(score(scaled, truth)) == verdict


def test_several_bags_end_with_the_pooled_table_and_one_footnote():
    tables = format_tables([a_summary(1, 'first'), a_summary(9, 'second')]).split('\n\n')
    assert [text.split()[0] for text in tables] == ['first', 'second', 'pooled']
    assert [('EI: mean of' in text) for text in tables] == [False, False, True]
    assert len(format_tables([a_summary()]).split('\n\n')) == 1


def test_the_live_evaluator_pays_for_no_heavy_import():
    code = (
        'import sys, wsn_tracking.evaluation.plots, wsn_tracking.evaluation.report_json, '
        'wsn_tracking.evaluation.table, wsn_tracking.evaluation.metrics; '
        'print(sorted({"scipy", "matplotlib", "rich"} & set(sys.modules)))'
    )
    done = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == '[]'

"""From claims to the report: what is written follows from the JSON, and the JSON from the filters."""

import json
import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from reproduction_cases import SETTING, measured, small

from wsn_tracking import cli
from wsn_tracking.errors import TrackingError
from wsn_tracking.files import check_folder
from wsn_tracking.filters import information, srckf
from wsn_tracking.reproduction import content as contents
from wsn_tracking.reproduction import reproduce
from wsn_tracking.reproduction.catalogue import CLAIMS, experiments_of, wanted
from wsn_tracking.reproduction.content import content
from wsn_tracking.reproduction.guide import ADVICE
from wsn_tracking.reproduction.page import page
from wsn_tracking.reproduction.reproduce import write
from wsn_tracking.reproduction.verdicts import verdicts


@pytest.fixture(scope='module')
def found():
    """One claim of a document that is reproduced, one that is not, one that cannot be, one beyond."""
    return measured(['A1', 'B3', 'B4', 'B21'], 4)


@pytest.fixture(scope='module')
def report(found):
    return page(found)


def badges(text):
    """The verdict that a page shows for each claim."""
    shown = re.findall(r'<section id="(\w+)"><h4>[^<]*<span class="v [\w-]+">([\w ]+)</span>', text)
    return dict(shown)


def test_report_and_digest_show_what_the_verdicts_of_the_json_are(found, tmp_path):
    html, plain, short = write(tmp_path, found)
    kept = json.loads(plain.read_text('utf-8'))
    assert badges(html.read_text('utf-8')) == verdicts(kept) == kept['verdicts']
    assert verdicts(kept)['B4'] == 'not reproducible'
    told = re.findall(r'^\| (\w\d+) \|.*\*\*([\w ]+)\*\*', short.read_text('utf-8'), re.MULTILINE)
    assert dict(told) == verdicts(kept)


def test_a_changed_figure_changes_the_verdict_in_the_report(found):
    changed = json.loads(json.dumps(found))
    (b21,) = [claim for claim in changed['claims'] if claim['id'] == 'B21']
    before = badges(page(changed))
    b21['figures'][0]['interval_95'] = [1.2, 1.3]
    after = badges(page(changed))
    assert after.pop('B21') == 'does not hold'
    assert after == {name: word for name, word in before.items() if name != 'B21'}


def test_the_report_needs_nothing_from_elsewhere(report):
    assert 'http' not in re.sub(r'base64,[\w+/=]*', '', report)
    places = {f'#{name}' for name in re.findall(r' id="(\w+)"', report)}
    assert all(link in places or link.startswith('data:') for link in re.findall(r'(?:src|href)="([^"]+)', report))


def test_every_claim_with_figures_has_a_picture(found, report):
    """Its own, or its figures beside the rules."""
    told = {claim['id']: claim for claim in found['claims']}
    assert told['A1']['plots']
    assert not told['B4']['plots']
    sections = re.findall(r'<section id="(\w+)">(.*?)</section>', report, re.DOTALL)
    pictures = {name: text.count('<img') for name, text in sections}
    assert pictures == {name: len(claim['plots']) or 1 for name, claim in told.items()}


def test_every_claim_in_one_line_names_a_figure_that_its_verdict_rests_on(found, report):
    lines = re.findall(r'<tr><td><a href="#(\w+)">.*?</tr>', report)
    assert lines[: len(found['claims'])] == [claim['id'] for claim in found['claims']]
    (line,) = re.findall(r'<tr><td><a href="#A1">A1</a>.*?</tr>', report)
    (a1,) = [claim for claim in found['claims'] if claim['id'] == 'A1']
    assert f'EI(q = 2) / EI(7): <b>{a1["figures"][0]["value"]:.4g}</b>' in line


def test_the_json_is_the_same_again(found):
    assert measured(['A1', 'B3', 'B4', 'B21'], 4) == found


def test_a_claim_says_how_to_compute_it(found):
    for claim in found['claims']:
        assert claim['command'] == f'./wsn-tracking reproduce {claim["id"]} --seed 31 --quick'
        assert claim['runs'] == 4


def wrong_sign(monkeypatch):
    """The filters of A step away from what they measure."""
    right = srckf.condition

    def wrong(prior, *rest):
        posterior = right(prior, *rest)
        return posterior._replace(m=2.0 * prior.m - posterior.m)

    monkeypatch.setattr(srckf, 'condition', wrong)


def test_with_the_sign_of_the_gain_changed_the_verdicts_of_a_fail(monkeypatch):
    names = ['A1', 'A2', 'A3']
    assert set(measured(names, 30)['verdicts'].values()) <= {'reproduced', 'in shape'}
    wrong_sign(monkeypatch)
    with np.errstate(all='ignore'):
        assert set(measured(names, 30)['verdicts'].values()) == {'not reproduced'}


def test_with_the_sign_of_the_innovation_changed_the_verdicts_of_b_fail(monkeypatch):
    names = ['B1', 'B2']
    assert set(measured(names, 10)['verdicts'].values()) == {'reproduced'}
    right = information.innovation
    monkeypatch.setattr(information, 'innovation', lambda z, z_hat: -right(z, z_hat))
    assert set(measured(names, 10)['verdicts'].values()) == {'not reproduced'}


# ---- the catalogue


def test_every_claim_has_an_id_of_its_own_that_begins_with_its_document():
    ids = [claim.id for claim in CLAIMS]
    assert len(set(ids)) == len(ids)
    assert all(claim.id[0] == claim.document for claim in CLAIMS)


def test_experiments_of_one_name_are_one():
    every = [claim.experiment for claim in CLAIMS if claim.experiment]
    assert len({e.name for e in every}) == len(experiments_of(CLAIMS)) == len(set(every))
    assert all(0 < e.quick <= e.units for e in every)


def test_advice_rests_on_claims_that_exist():
    assert {name for *_, names in ADVICE for name in names} <= {claim.id for claim in CLAIMS}


def test_claims_are_found_by_document_and_by_id():
    assert [c.id for c in wanted(['B4', 'A2'])] == ['A2', 'B4']
    assert {c.document for c in wanted(['B'])} == {'B'}
    assert wanted([]) == list(CLAIMS)
    assert [c.document for c in CLAIMS] == sorted(c.document for c in CLAIMS)
    with pytest.raises(TrackingError, match='no claim or document `Z1`'):
        wanted(['Z1'])


def test_what_is_not_a_number_is_null_and_fails():
    (claim,) = small(['B21'], 4)
    given = {'quantity': np.array([1.0, np.inf, 2.0])}
    from wsn_tracking.reproduction.quantities import curve, mean

    odd = claim._replace(
        figures=lambda s: [mean('odd', s['quantity'], shape=(0.0, 5.0))],
        plots=lambda s: [contents.Plot('p', 'x', 'y', [curve('odd', [0.0], s['quantity'][:, None])])],
    )
    with np.errstate(invalid='ignore'):
        made = content([odd], {claim.experiment.name: given}, SETTING)
    json.dumps(made, allow_nan=False)
    assert made['claims'][0]['figures'][0]['value'] is None
    assert made['verdicts'] == {'B21': 'does not hold'}
    assert 'svg' in page(made)


def test_what_was_changed_since_the_commit_is_told(tmp_path, monkeypatch):
    """Anywhere in the package."""
    module, filters = tmp_path / 'package' / 'reproduction' / 'content.py', tmp_path / 'package' / 'filters.py'
    module.parent.mkdir(parents=True)
    for path in (module, filters):
        path.write_text('')

    def git(*arguments):
        subprocess.run(['git', '-C', str(tmp_path), *arguments], check=True, capture_output=True)  # noqa: S607

    git('init')
    git('add', '.')
    git('-c', 'user.name=n', '-c', 'user.email=e', 'commit', '-m', 'm')
    monkeypatch.setattr(contents, '__file__', str(module))
    assert re.fullmatch('[0-9a-f]{12}', contents.commit())
    filters.write_text('changed')
    assert re.fullmatch('[0-9a-f]{12} with changes', contents.commit())


def test_sources_outside_of_a_working_copy_have_no_commit(monkeypatch):
    assert contents.commit()
    monkeypatch.setenv('PATH', '')
    assert contents.commit() == 'unknown'


# ---- the command


def run_cli(capsys, *arguments):
    with pytest.raises(SystemExit) as ended:
        cli.main(['reproduce', *arguments])
    return ended.value.code, capsys.readouterr()


def test_the_command_writes_both_files_and_tells_verdicts(tmp_path, capsys):
    code, told = run_cli(capsys, 'B4', '--quick', '--jobs', '1', '-o', str(tmp_path / 'report'))
    assert code == 0
    assert 'B4   not reproducible' in told.out
    kept = json.loads((tmp_path / 'report' / 'reproduction.json').read_text('utf-8'))
    assert kept['command'] == './wsn-tracking reproduce B4 --quick --seed 7001'
    assert kept['verdicts'] == {'B4': 'not reproducible'}
    assert (tmp_path / 'report' / 'reproduction.html').stat().st_size > 1000


@pytest.mark.parametrize(
    ('arguments', 'code', 'words'),
    [
        (['Z'], 1, 'expected A to E, X, or a claim as A3'),
        (['A99'], 1, 'expected one of A1, A2'),
        (['B4', '--jobs', '0'], 2, 'no number of workers'),
        (['B4', '--jobs', 'two'], 2, 'no number of workers'),
        (['B4', '--data', '.'], 1, 'add X to what is computed'),
    ],
)
def test_a_wrong_call_is_one_line(capsys, tmp_path, arguments, code, words):
    ended, told = run_cli(capsys, *arguments, '-o', str(tmp_path))
    assert ended == code
    assert words in told.err


def test_names_are_taken_in_any_case(tmp_path, capsys):
    assert run_cli(capsys, 'b4', '--quick', '--jobs', '1', '-o', str(tmp_path))[0] == 0
    kept = json.loads((tmp_path / 'reproduction.json').read_text('utf-8'))
    assert kept['command'] == './wsn-tracking reproduce B4 --quick --seed 7001'


@pytest.mark.parametrize('below', ['', 'below', 'below/it'])
def test_what_cannot_be_written_is_refused_before_the_work(capsys, tmp_path, monkeypatch, below):
    monkeypatch.setattr(reproduce, 'computed', lambda *_: pytest.fail('it works for nothing'))
    (tmp_path / 'file').write_text('')
    code, told = run_cli(capsys, 'B4', '-o', str(tmp_path / 'file' / below))
    assert code == 1
    assert 'cannot be written' in told.err
    assert told.err.count('\n') == 1
    assert [path.name for path in tmp_path.iterdir()] == ['file']


def test_a_folder_that_can_be_made_is_not_made_before_there_is_something_in_it(tmp_path):
    check_folder(tmp_path / 'new' / 'below')
    check_folder(tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_a_report_that_cannot_be_drawn_leaves_nothing(found, tmp_path, monkeypatch):
    def broken(content_):
        raise TrackingError('no pen')

    monkeypatch.setattr(reproduce, 'page', broken)
    with pytest.raises(TrackingError, match='no pen'):
        write(tmp_path, found)
    assert list(tmp_path.iterdir()) == []


COMMAND = (
    'import signal; from wsn_tracking import cli; signal.signal(signal.SIGINT, signal.default_int_handler); '
    "cli.main(['reproduce', 'A', '--jobs', '2', '-o', 'report'])"
)


def test_interrupted_it_ends_at_once_without_a_word_and_leaves_nothing(tmp_path):
    """Ctrl-C reaches the workers as well."""
    process = subprocess.Popen(
        [sys.executable, '-c', COMMAND], cwd=tmp_path, stderr=subprocess.PIPE, start_new_session=True
    )
    children = Path(f'/proc/{process.pid}/task/{process.pid}/children')
    try:
        while process.poll() is None and len(children.read_text().split()) < 3:  # two workers, and who cleans up
            os.sched_yield()
        os.killpg(process.pid, signal.SIGINT)
        told = process.communicate(timeout=60)[1]
    finally:
        process.kill()
    assert (process.returncode, told) == (130, b'')
    assert list(tmp_path.iterdir()) == []

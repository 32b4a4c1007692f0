"""docs/reproduction.md and README.md quote the figures that are committed beside them."""

import json
import re

import pytest

from live import ROOT
from wsn_tracking.reproduction.catalogue import CLAIMS
from wsn_tracking.reproduction.claims import BEYOND
from wsn_tracking.reproduction.digest import digest
from wsn_tracking.reproduction.verdicts import verdicts

PAGE = (ROOT / 'docs' / 'reproduction.md').read_text('utf-8')
KEPT = json.loads((ROOT / 'docs' / 'results' / 'reproduction.json').read_text('utf-8'))
FIGURES = {c['id']: {f['name']: f['value'] for f in c['figures']} for c in KEPT['claims']}
NUMBER = r'(-?\d+(?:\.\d+)?)'

# Words of the page with a @ for each number, the claim, and the figures that the numbers are.
QUOTED = [
    ('EI(2)/EI(7) @, EI(12)/EI(7) @', 'A1', ['EI(q = 2) / EI(7)', 'EI(q = 12) / EI(7)']),
    ('@ cm: path, nodes', 'A2', ['EI(q = 7)']),
    ('CI @ % (-0.25 %)', 'A5', ['CI [8,12]']),
    ('it is @ % worse', 'A7', ['local [6,8] against q = 7']),
    ('@ % with alpha = 0.27', 'A8', ['saved at alpha = 0.27 [%]']),
    ('@ m against @ m |', 'B1', ['RMSE, single model', 'RMSE, multi-model']),
    ('@ against @ m at 2 Hz', 'C1', ['RMSE, two curves', 'RMSE, RSS-MCL']),
    ('| by @ % |', 'C2', ['two curves better than RSS-MCL by']),
    ('@ against @ m, @ % better, simulated', 'C5', ['error, two curves', 'error, RSS-MCL', 'two curves better by']),
    ('| @ - 23.8 lg d', 'C7', ['one curve: P_ref']),
    ('settled after @ s, the EKF after @ s', 'D2', ['settling, hybrid', 'settling, EKF']),
    ('tracked to @ and @ cm', 'D4', ['RMSE, robot 1', 'RMSE, robot 2']),
    ('in phase to @ degrees', 'D5', ['phase error after 15 s']),
    ('RMSE @ of it at 10 % lost, @ at 90 %', 'E1', ['CKF / EKF, 10% lost', 'CKF / EKF, 90% lost']),
    ('RMSE @ of one that holds', 'E3', ['CKF / last value held, 70% lost']),
    ('EI @, 0.55, 0.68 of it', 'A21', ['EI, near and IPLF / document']),
    ('0.80, @, 0.68 of it', 'A22', ['EI, near and IPLF / document']),
    ('0.80, 0.55, @ of it', 'A23', ['EI, near and IPLF / document']),
    (
        'RMSE @, bytes @, messages @ of it; NEES @ (of 4) instead of @',
        'B21',
        ['RMSE, flood / cm', 'bytes, flood / cm', 'messages, flood / cm', 'NEES (of 4), flood', 'NEES (of 4), cm'],
    ),
    ('RMSE @ of it, three seconds later', 'C21', ['RMSE, improved / two curves']),
    (
        'RMSE @ of it, NEES @ (of 2) instead of',
        'D21',
        ['RMSE 2 s after the stop, two models / hybrid', 'NEES (of 2) 2 s after it, two models'],
    ),
]


@pytest.mark.parametrize(('words', 'claim', 'names'), QUOTED)
def test_numbers_are_quoted_as_they_were_found(words, claim, names):
    (told,) = re.findall(NUMBER.join(map(re.escape, words.split('@'))), PAGE)
    for text, name in zip([told] if isinstance(told, str) else told, names, strict=True):
        digits = len(text.partition('.')[2])
        assert float(text) == pytest.approx(FIGURES[claim][name], abs=0.51 * 10.0**-digits), name


def test_verdicts_are_those_of_the_last_full_run():
    assert not KEPT['quick']
    assert verdicts(KEPT) == KEPT['verdicts']
    assert set(KEPT['verdicts']) == {claim.id for claim in CLAIMS}
    rows = re.findall(r'^\| ([A-E]\d[\w, ]*) \| .* \| ([a-z ]+) \| .* \|$', PAGE, re.MULTILINE)
    told = {name: word for names, word in rows for name in names.split(', ')}
    documents = {c['id']: KEPT['verdicts'][c['id']] for c in KEPT['claims'] if c['kind'] != BEYOND}
    assert {name: told[name] for name in documents} == documents


def test_what_is_committed_in_short_is_of_the_same_run():
    assert (ROOT / 'docs' / 'results' / 'reproduction.md').read_text('utf-8') == digest(KEPT)


def test_nothing_that_is_committed_names_a_machine():
    for name in ('reproduction.json', 'reproduction.md'):
        assert '/tmp' not in (text := (ROOT / 'docs' / 'results' / name).read_text('utf-8'))  # noqa: S108
        assert '--data DATA' in text

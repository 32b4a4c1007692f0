"""docs/reproduction.md and README.md quote the figures that are committed beside them."""

import re
from collections import Counter

import pytest

from live import ROOT
from quotes import quoted, told
from reproduced import FIGURES, KEPT, PAGE, README, ends
from wsn_tracking.reproduction.catalogue import CLAIMS
from wsn_tracking.reproduction.claims import BEYOND
from wsn_tracking.reproduction.digest import digest
from wsn_tracking.reproduction.verdicts import verdicts

WORDS = {'two': 2, 'three': 3}

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
    quoted(*zip(told(words, PAGE), [FIGURES[claim][name] for name in names], strict=True))


# ---- what is told of several figures at once


def documents(claim):
    """What a claim's figures are, of what the document says."""
    (shown,) = (c for c in KEPT['claims'] if c['id'] == claim)
    return {f['name']: f['value'] / f['document'] for f in shown['figures'] if f['document']}


def named(claim, *words):
    return [value for name, value in FIGURES[claim].items() if all(word in name for word in words)]


def ratios(*names):
    """Of two figures of A21, A22 and A23."""
    return [FIGURES[claim][names[0]] / FIGURES[claim][names[1]] for claim in ('A21', 'A22', 'A23')]


OURS, THEIRS = 'an epoch, near and IPLF', 'an epoch, document'
SUMMED = [
    (
        '[2,6] is @ % worse than [6,8], not @ %',
        lambda: [
            100.0 * (ratio - 1.0)
            for ratio in (
                FIGURES['A3']['EI [2,6] / EI [6,8]'],
                FIGURES['A3']['EI [2,6] / EI [6,8]'] / documents('A3')['EI [2,6] / EI [6,8]'],
            )
        ],
    ),
    ('the gains are @ as large', lambda: [documents('A4')['mean [2,6]']]),
    ('the gains are @ as large', lambda: [documents('A4')['LCI [2,6]']]),
    ('and @ % with CI', lambda: [FIGURES['A7']['CI [6,8] against q = 7']]),
    (
        'with 100 rounds within @ %, with 20 within @ %',
        lambda: [100.0 * (max(named('B2', rounds)) - 1.0) for rounds in ('100 rounds', '20 rounds')],
    ),
    ('none of @ 000 random layouts', lambda: [next(c for c in KEPT['claims'] if c['id'] == 'B4')['runs'] / 1000.0]),
    ('by @ to @ %: all but a tie', lambda: ends([100.0 * (1.0 - value) for value in named('E2', 'UKF')])),
    (
        'messages @ to @, bytes @ to @ |',
        lambda: [end for unit in ('messages ', 'bytes ') for end in ends(ratios(unit + OURS, unit + THEIRS))],
    ),
    (
        'NEES @ (of 2) instead of @; RMSE @ % above a particle filter, instead of @ %',
        lambda: [
            *named('A24', 'the same, noise at the predicted'),
            *named('A24', 'document: noise'),
            *(100.0 * (value - 1.0) for value in named('A24', '/ particle filter')),
        ],
    ),
    (
        'a centre comes within @ % of the Cramer-Rao recursion, flooding within @ %, averages within @ %',
        lambda: [100.0 * (value - 1.0) for value in FIGURES['B25'].values()],
    ),
    (
        'three seconds later @;',
        lambda: [named('C21', 'improved / two')[0] * named('C21', '3 s later / improved')[0]],
    ),
    (
        'with 10 % outliers RMSE @ of it, with a body that is turned by 30 degrees @ |',
        lambda: [*named('C23', 'outliers: improved'), *named('C23', 'turned 30 deg: improved')],
    ),
    (
        '(of 2) instead of @; @ % noisier before',
        lambda: [*named('D21', '2 s after it, hybrid'), 100.0 * (named('D21', 'RMSE before the stop, two')[0] - 1.0)],
    ),
    (
        'within @ to @ % of a filter that is linearised at the truth',
        lambda: ends([100.0 * (value - 1.0) for value in named('E21', 'RMSE / best')]),
    ),
    ('NEES @ (of 2) at every loss rate', lambda: [min(named('E21', 'NEES'))]),
    ('NEES @ (of 2) at every loss rate', lambda: [max(named('E21', 'NEES'))]),
]


@pytest.mark.parametrize(('words', 'values'), SUMMED)
def test_what_is_told_of_several_figures_follows_from_them(words, values):
    quoted(*zip(told(words, PAGE), values(), strict=True))


def test_more_particles_are_no_better():
    assert '2000 particles instead of 500 are no better' in PAGE
    assert FIGURES['C21']['RMSE, improved, 500 particles / 2000'] < 1.0


def test_fusion_gains_a_quarter_to_a_third_of_what_is_told():
    assert 'a quarter to a third of the gain' in PAGE
    assert all(0.2 < part < 0.35 for part in documents('A6').values())


# ---- the README


def test_the_readme_tells_how_many_claims_hold():
    words = ' '.join(README.split())
    counts = re.search(
        r'Of (\d+) claims (\d+) are reproduced, (\d+) hold in shape, (\w+) are not found, (\w+) cannot be repeated',
        words,
    ).groups()
    assert [WORDS.get(text) or int(text) for text in counts] == counted()
    counts = re.search(
        r'Of (\d+) claims, (\d+) are reproduced, (\d+) hold in shape, (\w+) are not found, and (\w+) cannot', PAGE
    ).groups()
    assert [WORDS.get(text) or int(text) for text in counts] == counted()


def counted():
    """Claims of the documents, and those of each verdict."""
    found = Counter(KEPT['verdicts'][c['id']] for c in KEPT['claims'] if c['kind'] != BEYOND)
    kinds = ('reproduced', 'in shape', 'not reproduced', 'not reproducible')
    assert set(found) <= set(kinds)
    return [found.total(), *(found[kind] for kind in kinds)]


def test_the_readme_tells_what_is_better_as_it_was_found():
    error = 'EI, near and IPLF / document'
    words = 'the near trigger with one iterated filter has @, @ and @ of the error'
    quoted(*zip(told(words, README), [FIGURES[claim][error] for claim in ('A21', 'A22', 'A23')], strict=True))
    words = "flooding has @ of the error of the second's averages with @ of their bytes"
    quoted(
        *zip(
            told(words, README),
            [FIGURES['B21'][name] for name in ('RMSE, flood / cm', 'bytes, flood / cm')],
            strict=True,
        )
    )


# ---- verdicts, and what is committed beside


def test_verdicts_are_those_of_the_last_full_run():
    assert not KEPT['quick']
    assert verdicts(KEPT) == KEPT['verdicts']
    assert set(KEPT['verdicts']) == {claim.id for claim in CLAIMS}
    rows = re.findall(r'^\| ([A-E]\d[\w, ]*) \| .* \| ([a-z ]+) \| .* \|$', PAGE, re.MULTILINE)
    words = {name: word for names, word in rows for name in names.split(', ')}
    known = {c['id']: KEPT['verdicts'][c['id']] for c in KEPT['claims'] if c['kind'] != BEYOND}
    assert {name: words[name] for name in known} == known


def test_what_is_committed_in_short_is_of_the_same_run():
    assert (ROOT / 'docs' / 'results' / 'reproduction.md').read_text('utf-8') == digest(KEPT)


def test_nothing_that_is_committed_names_a_machine():
    for name in ('reproduction.json', 'reproduction.md'):
        assert '/tmp' not in (text := (ROOT / 'docs' / 'results' / name).read_text('utf-8'))  # noqa: S108
        assert '--data DATA' in text

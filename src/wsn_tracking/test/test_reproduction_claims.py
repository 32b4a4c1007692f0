"""Every claim, with two runs of each experiment: what it shows, not how it comes out."""

import json

import numpy as np
import pytest
from reproduction_cases import SETTING

from wsn_tracking.reproduction import c_sweeps
from wsn_tracking.reproduction.catalogue import CLAIMS, experiments_of
from wsn_tracking.reproduction.claims import BEYOND, MEASURED, PICTURE
from wsn_tracking.reproduction.content import content
from wsn_tracking.reproduction.engine import unit
from wsn_tracking.reproduction.forest import shown
from wsn_tracking.reproduction.page import page

OWN = [claim for claim in CLAIMS if claim.document != 'X']  # those of all systems: test_reproduction_cross.py
RUNS = 2


@pytest.fixture(scope='module', autouse=True)
def shorter():
    """Three of the noises and spacings of C."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(c_sweeps, 'NOISES', c_sweeps.NOISES[:1] + c_sweeps.NOISES[2:4])
        patch.setattr(c_sweeps, 'SPACINGS', dict(list(c_sweeps.SPACINGS.items())[:3]))
        yield


@pytest.fixture(scope='module')
def samples(shorter):
    small = [e._replace(runs=RUNS) for e in experiments_of(OWN)]
    return {e.name: unit(e, 41, 0).samples for e in small}


@pytest.fixture(scope='module')
def found(samples):
    with np.errstate(invalid='ignore', divide='ignore'):
        return content(OWN, samples, SETTING)


def test_quantities_are_finite_and_of_every_run(samples):
    for name, quantities in samples.items():
        for key, values in quantities.items():
            if not key.startswith((PICTURE, MEASURED)):
                assert len(values) == RUNS, (name, key)
                assert not np.any(np.isinf(values)), (name, key)


def test_every_claim_has_figures_or_says_why_not(found):
    for claim in found['claims']:
        assert bool(claim['figures']) != (bool(claim['impossible']) and claim['experiment'] is None), claim['id']
        names = [figure['name'] for figure in claim['figures']]
        assert len(set(names)) == len(names), claim['id']


def test_every_claim_has_a_plot_or_nothing_to_draw(found):
    for claim in found['claims']:
        assert bool(claim['plots'] or shown(claim['figures'])) == bool(claim['figures']), claim['id']


def test_every_number_of_a_document_stands_beside_ours():
    """What the documents print: section, table and figure of each is named by a claim."""
    places = ' '.join(f'{claim.document} {claim.place};' for claim in CLAIMS if claim.kind != BEYOND)
    for place in (
        *('A figure 2', 'A section 3.1', 'A table 1', 'A section 3.2', 'A figure 4', 'A figure 5', 'A figures 6 and 7'),
        *('B figure 1', 'B figures 2 and 3', 'B figures 4 and 5', 'C figure 1', 'C figure 3', 'C figure 4'),
        *('C figure 5', 'C figure 6', 'C section 5', 'D table 1', 'D figure 4', 'D figure 5', 'E abstract'),
    ):
        assert place in places


@pytest.mark.parametrize(
    ('claim', 'printed'),
    [
        ('A2', [9.2233]),
        ('A3', [10.7682, 9.6613, 9.4899, 9.7113, 9.3252, 9.2281, 9.1948, 10.6792, 9.1985]),
        ('A8', [56.54]),
        ('C1', [0.27, 0.93]),
        ('C2', [56.2]),
        ('C5', [0.64, 0.98, 34.7]),
    ],
)
def test_printed_numbers_are_told(found, claim, printed):
    (shown,) = [c for c in found['claims'] if c['id'] == claim]
    told = [figure['document'] for figure in shown['figures'] if figure['document'] is not None]
    assert all(any(number == pytest.approx(value, rel=1e-4) for value in told) for number in printed)


def test_whatever_is_measured_can_be_written_and_drawn(found):
    plain = json.loads(json.dumps(found, allow_nan=False))
    drawn = {claim['document']: claim for claim in plain['claims'] if claim['plots']}  # drawing all takes its time
    assert set(drawn) == {'A', 'B', 'C', 'D', 'E'}
    text = page({**plain, 'claims': list(drawn.values())})
    assert text.count('<img') == sum(len(claim['plots']) for claim in drawn.values())


def test_every_system_is_beside_another_with_its_honesty(found):
    """Beyond the documents: accuracy, NEES, and a reference, for each of the five."""
    for letter in 'ABCDE':
        beyond = [c for c in found['claims'] if c['document'] == letter and c['kind'] == BEYOND]
        names = [f['name'] for c in beyond for f in c['figures']]
        assert any('NEES' in name for name in names), letter
        assert any(word in name for name in names for word in ('bound', 'best', 'particle', '2000')), letter
        assert letter == 'D' or any(word in name for name in names for word in ('messages', 'readings')), letter

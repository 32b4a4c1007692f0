"""docs/calibration.md quotes the figures that are committed beside it."""

import json

from live import ROOT
from quotes import quoted, table, texts

PAGE = (ROOT / 'docs' / 'calibration.md').read_text('utf-8')
RADIO = json.loads((ROOT / 'docs' / 'results' / 'real_radio.json').read_text())['studies']
STRENGTHS = ('as_configured', 'calibrated_path_loss', 'radio_map')
SETS = {
    'danis, four tracks': ('danis_central', STRENGTHS),
    'kolakowski, robot': ('kolakowski', STRENGTHS),
    'lias mid': ('lias', ('uncalibrated', 'calibrated')),
    'plaza2': ('plaza2', ('uncalibrated', 'calibrated')),
}


def test_what_calibrations_give_is_quoted():
    for what, *cells in table(PAGE, 'set | without'):
        for name, keys in (kept for begin, kept in SETS.items() if what.startswith(begin)):
            for cell, key in zip(cells, keys, strict=False):
                rmse, nees = texts(cell)[0], cell.rpartition('(')[2].rstrip(')').removeprefix('NEES ')
                quoted((rmse, RADIO[name][key]['rmse_m']), (nees, RADIO[name][key]['nees']))

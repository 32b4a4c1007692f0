"""docs/calibration.md quotes the figures that are committed beside it."""

from quotes import page, quoted, results, table, texts

PAGE = page('calibration')
RADIO = results('real_radio')['studies']
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

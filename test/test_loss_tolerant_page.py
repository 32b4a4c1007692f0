"""docs/loss_tolerant.md quotes the figures that are committed beside it."""

import re
from functools import partial

from quotes import page, quoted, results, table, texts

PAGE = page('loss_tolerant')
STUDIES = results('loss_tolerant')['studies']
LIAS = results('real_radio')['studies']['lias_lost']
rows = partial(table, PAGE)

KINDS = {
    'each link on its own': 'independent',
    'links, bursts of 10 epochs': 'bursts',
    'whole rounds': 'rounds',
    'whole rounds, bursts of 10': 'rounds_in_bursts',
}
ROWS = ('ckf', 'ukf', 'ekf', 'hold', 'ckf_rounds', 'ckf_bursts_of_20', 'ckf_uncalibrated')


def percent(text, share):
    """That a share is quoted, in percent."""
    quoted((text.removesuffix(' %'), 100.0 * share))


def test_independent_losses_are_quoted():
    for rate, rmse, *cells in rows('loss | ckf RMSE'):
        found = STUDIES['loss_rate']['by_rate'][f'loss_{rate}']
        quoted((rmse.removesuffix(' m'), found['rmse_m']['ckf']))
        quoted(
            *((cell, found['ckf_of'][name]['value']) for cell, name in zip(cells, ('ekf', 'ukf', 'hold'), strict=False))
        )
        nees = found['nees_of_the_median_run']
        quoted(*((cell, nees[name]) for cell, name in zip(cells[3:], ('ckf', 'ekf', 'hold'), strict=False)))
        for cell, name in zip(cells[6:], ('ckf', 'ekf', 'hold'), strict=True):
            percent(cell, found['lost_tracks'][name])


def test_bursts_and_whole_rounds_are_quoted():
    for rate, kind, *cells, nees in rows('loss | kind'):
        found = STUDIES['loss_kind']['by_rate_and_kind'][f'loss_{rate}'][KINDS[kind]]
        for rmse, lost, name in zip(cells, cells[3:], ('ckf', 'ekf', 'hold'), strict=False):
            quoted((rmse.removesuffix(' m'), found['rmse_of_the_median_run_m'][name]))
            percent(lost, found['lost_tracks'][name])
        quoted((nees, found['nees_of_the_median_run']['ckf']))


def test_ranges_of_a_trolley_are_quoted():
    for name, (_, *cells, ratio) in zip(ROWS, rows('| 0 % lost'), strict=True):
        found = [LIAS[f'loss_{rate}'].get(name) for rate in ('0', '0.5', '0.9')]
        for cell, one in zip(cells, found, strict=True):
            if cell:
                rmse, nees = texts(cell)
                quoted((rmse, one['rmse_m']), (nees, one['nees']))
        whole = found[0] or LIAS['loss_0']['ckf']
        quoted((ratio, found[2]['rmse_m'] / whole['rmse_m']))
    (least, most) = re.findall(r'make the filter cautious \(NEES ([\d.]+) to ([\d.]+)\)', PAGE)[0]
    nees = [LIAS[f'loss_{rate}'][name]['nees'] for rate in ('0', '0.5', '0.9') for name in ('ckf', 'ukf', 'ekf')]
    quoted((least, min(nees)), (most, max(nees)))

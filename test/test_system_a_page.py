"""docs/system_a.md quotes the figures that are committed beside it."""

import re
from functools import partial

import pytest

from live import ROOT
from quotes import numbers, page, quoted, results, table, told

PAGE = page('system_a')
A = results('system_a')['studies']
RADIO = results('real_radio')['studies']
REJOIN = results('live')['studies']['rejoin']['rows']
CENTRAL = {
    'danis_central': {
        'gaussian_ckf': '| cubature filter',
        'forgotten_velocity': '| + velocities',
        'iterated': '| + iterated',
        'student_t': '| + Student-t',
        'drifting_offsets': '| + drifting',
        'kappa_2': '| + sigma points',
        'calibrated_path_loss': '| + path loss',
        'radio_map': '| + radio map',
        'tried_radio_map_velocity_kept': '| tried with the radio map',
        'tried_gate_3': '| tried on the configuration: gate',
        'tried_without_area': '| tried on the configuration: not kept',
    },
    'kolakowski': {
        'gaussian_ckf': '| cubature filter',
        'forgotten_velocity': '| + velocities',
        'iterated': '| + iterated',
        'student_t': '| + Student-t',
        'drifting_offsets': '| + drifting',
        'calibrated_path_loss': '| + path loss',
        'radio_map': '| + radio map',
        'tried_radio_map_velocity_kept': '| tried with the radio map',
        'kappa_2': '| tried on the configuration: `update.kappa`',
        'tried_gate_3': '| tried on the configuration: gate',
        'tried_without_area': '| tried on the configuration: not kept',
    },
}


rows = partial(table, PAGE)


@pytest.mark.parametrize('name', CENTRAL)
def test_the_ladders_of_signal_strengths_are_the_studys(name):
    for (key, words), (what, rmse, best, nees) in zip(CENTRAL[name].items(), rows(f'`{name}`,'), strict=True):
        assert f'| {what}'.startswith(words)
        found = RADIO[name][key]
        quoted((nees, found['nees']))
        if rmse:
            quoted((rmse.removesuffix(' m'), found['rmse_m']))
        if best:
            quoted((best.removesuffix(' m'), found.get('best_of_densities', found)['rmse_m']))
    assert RADIO['kolakowski']['as_configured']['rmse_m'] == RADIO['kolakowski']['drifting_offsets']['rmse_m']


def test_three_estimators_are_quoted():
    for key, (_, *cells) in zip(('feedback', 'no_feedback', 'radio_map'), rows('`danis_three`,'), strict=True):
        found = RADIO['danis_three'][key]
        values = [*found['local_rmse_m'], found['mean_of_the_locals_rmse_m'], found['fused']['rmse_m']]
        assert numbers(*cells[:3]) == pytest.approx(values, abs=0.0051)
        quoted((cells[3], found['fused']['nees']))


def test_the_readme_says_the_same():
    told = (ROOT / 'README.md').read_text('utf-8')
    for words, found in (
        ('danis, 4 tracks pooled', RADIO['danis_central']['as_configured']),
        ('the same with a radio map', RADIO['danis_central']['radio_map']),
        ('danis, three estimators', RADIO['danis_three']['feedback']['fused']),
        ('kolakowski', RADIO['kolakowski']['as_configured']),
        ('lias', RADIO['lias']['calibrated']),
        ('plaza2', RADIO['plaza2']['calibrated']),
    ):
        (rmse, nees), *others = re.findall(rf'^\| {words}.*\| ([\d.]+) m \| ([\d.]+) \|$', told, re.MULTILINE)
        assert not others
        quoted((rmse, found['rmse_m']), (nees, found['nees']))


def test_what_finding_a_track_anew_is_worth_is_quoted():
    found = RADIO['danis_found_again']
    wrong, silent = (numbers(*cells) for _, *cells in rows('| goes on'))
    names = ('goes_on', 'gate_alone', 'gate_and_rejects', 'odds')
    assert wrong == pytest.approx([found['wrong_start'][name]['rmse_m'] for name in names], abs=0.0051)
    names = ('goes_on', 'found_anew', 'odds')
    assert silent == pytest.approx([found['silences'][name]['rmse_m'] for name in names], abs=0.0051)


def test_what_leaving_tracks_out_gives_is_quoted():
    (line,) = re.findall(r'about the configured one: (.*?)\.\n- ', PAGE, re.DOTALL)
    path_loss, with_map = (RADIO['danis_left_out'][channel]['local_1'] for channel in ('path_loss', 'radio_map'))
    told = [found[name] for name in ('rmse_m', 'least_m', 'most_m') for found in (path_loss, with_map)]
    assert [x for x in numbers(line) if x != 27] == pytest.approx(told, abs=0.0051)


def test_ranges_are_quoted():
    for name, (_, _, *cells) in zip(('lias', 'plaza2', 'labyrinth'), rows('ranges,'), strict=True):
        found = RADIO[name]
        both = [found['uncalibrated'], found['calibrated']]
        quoted(
            *((cells[i].removesuffix(' m'), both[i]['rmse_m']) for i in (0, 1)),
            *((cells[2 + i], both[i]['nees']) for i in (0, 1)),
            (cells[4].removesuffix(' m'), found['range_std_m']),
        )


def test_fusion_rules_are_quoted():
    for what, local, *changes in rows('q from'):
        found = A['fusion_rules']['ckf_measured']['q_{:g}_to_{:g}'.format(*numbers(what))]
        quoted((local.removesuffix(' cm'), found['local_ei_cm']['value']))
        for rule, text in zip(('trace', 'mean', 'lci', 'optimal', 'ici'), changes, strict=True):
            quoted((text, found['change_percent'][rule]['value']))


def test_process_noises_are_quoted():
    for r, (_, *cells) in zip(('measured', 'predicted'), rows('q | 2'), strict=True):
        for q, text in zip((2, 4, 5, 6, 7, 8, 9, 10, 12), cells, strict=True):
            if q != 7:
                quoted((text, A['process_noise'][f'ckf_{r}']['ei_of_q_7'][f'q_{q}']['value']))


def test_triggers_are_quoted():
    name = ''
    for where, kind, sent, document, iplf in rows('scenario | trigger | sent'):
        name = where.strip('`') or name
        found = A['data_rate'][name]['triggers'][kind.split('`')[1]]
        quoted((sent, found['sent_of_event']['value']), (document, found['ei_cm_document']['value']))
        quoted((iplf, found['ei_cm_iplf']['value']))
    (line,) = re.findall(r'at the same data rate: (.*?)\. Near', PAGE, re.DOTALL)
    for name, text in zip(('a_loop', 'a_circle', 'a_heading'), line.split(','), strict=True):
        value, half = (part.strip() for part in text.split('±'))
        found = A['data_rate'][name]['near_iplf_of_event_document']
        low, high = found['interval_95']
        quoted((value, found['value']), (half, 0.5 * (high - low)))


def test_updates_and_shares_are_quoted():
    found = A['update_forms']
    for key, (_, ei, change, nees) in zip(found['ei_cm'], rows('`update`'), strict=True):
        quoted((ei.removesuffix(' cm'), found['ei_cm'][key]['value']), (nees, found['position_nees'][key]['value']))
        if change:
            quoted((change.removesuffix(' %'), 100.0 * (found['ei_of_ckf_measured'][key]['value'] - 1.0)))
    for alpha, text in zip(('0.2', '0.25', '0.27', '0.3', '0.5'), rows('`alpha`')[0][1:], strict=True):
        quoted((text, A['trigger_rate']['sent_of_in_radius'][f'alpha_{alpha}']['value']))


def test_how_soon_an_estimator_that_was_killed_is_fused_again_is_quoted():
    live, longest, replay, longest_replay = told(
        'is fused again @ s later with the timeouts of a live network (at the longest of ten times @ s) and @ s later '
        'in a replay (@ s)',
        PAGE,
    )
    found = {row['timeouts']: row for row in REJOIN}
    assert {row['repeats'] for row in REJOIN} == {10}
    quoted((live, found['live']['median_s']), (longest, found['live']['longest_s']))
    quoted((replay, found['replay']['median_s']), (longest_replay, found['replay']['longest_s']))
    assert max(row['longest_s'] for row in REJOIN) < 5.0


def test_two_hosts_are_quoted():
    compared, repeats = told('none of @ estimates of @ runs over two hosts differs', (ROOT / 'README.md').read_text())
    found = results('hosts')['studies']['hosts']
    assert (int(compared), int(repeats), 0) == (found['compared'], found['repeats'], found['differing'])

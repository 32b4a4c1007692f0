"""docs/hybrid.md quotes the figures that are committed beside it."""

from functools import partial

from quotes import page, quoted, results, table, told

PAGE = page('hybrid')
STOP, LOST, GATE, FROZEN = (
    results('hybrid')['studies'][name] for name in ('sudden_stop', 'lost_ranges', 'gate', 'frozen_gain')
)
REAL = results('hybrid_real')['studies']
FOLLOWER = results('follower')['studies']['phase']['variants']
LIVE = results('live')['studies']['targets']
rows = partial(table, PAGE)

FORMS = {
    'EKF': 'ekf',
    '`inflate`': 'inflate',
    '`decay`': 'decay',
    '`imm`': 'imm',
    'least squares': 'ls',
    'least squares, low-passed': 'ls_low_passed',
}
VARIANTS = (
    'default',
    'constant_angular_speed',
    'truth_fed_back',
    'feedback_at_2_hz',
    'feedback_200_ms_late',
    'half_of_the_feedback_lost',
    'a_third_of_the_ranges_lost',
)


def test_stops_are_quoted():
    q_w = '0.001'
    for what, *cells in rows('| before the stop'):
        if what.startswith('**'):
            q_w = '0.01' if '0.01 ' in what else q_w  # the last forms are the same whatever q_w
            continue
        for scenario, three in (('d_stop', cells[:3]), ('d_arc_stop', cells[4:])):
            found, form = STOP[f'{scenario}, q_w = {q_w} m^2/s^3'], FORMS[what]
            before, after = (found[f'rmse_cm_{when}'][form]['value'] for when in ('before', '2_s_after'))
            quoted((three[0], before), (three[1], after), (three[2].removesuffix(' s'), found['settling_s'][form]))


def test_what_the_forms_are_worth_is_quoted():
    sure, loose = (STOP[f'd_stop, q_w = {q_w} m^2/s^3'] for q_w in ('0.001', '0.01'))
    ratio = sure['ekf_of_hybrid_2_s_after']
    settling = sure['settling_s']
    words = told('(EKF / hybrid @, [@, @]) and settles @ times as fast, at no cost before (@)', PAGE)
    values = (ratio['value'], *ratio['interval_95'], settling['ekf'] / settling['inflate'])
    quoted(*zip(words, (*values, sure['hybrid_of_ekf_before']['value']), strict=True))
    quoted((told('the hybrid gains @ %.', PAGE)[0], 100 * (1 - 1 / loose['ekf_of_hybrid_2_s_after']['value'])))
    quoted((told('better answer throughout: @ %', PAGE)[0], 100 * (1 - loose['imm_of_hybrid_2_s_after']['value'])))
    noisy = told('settles first and is @ to @ times as noisy', PAGE)
    quoted(*zip(noisy, (found['ls_of_ekf_before']['value'] for found in (loose, sure)), strict=True))
    arc = STOP['d_arc_stop, q_w = 0.001 m^2/s^3']['hybrid_of_ekf_before']['value']
    quoted((told('With q_w = 0.001 the hybrid has @ %', PAGE)[0], 100 * arc))
    lost = told('hybrid / EKF is @ on `d_stop` and @ on the round', PAGE)
    quoted(*zip(lost, (LOST[name]['hybrid_of_ekf']['value'] for name in ('d_stop', 'd_dropout')), strict=True))
    cost = GATE['q_w = 0.001 m^2/s^3']['gate_of_open_2_s_after']['value']
    quoted((told('gate costs @ % after a stop', PAGE)[0], 100 * (cost - 1)))
    quoted((told('has 1 / @ of the EKF', PAGE)[0], FROZEN['ekf_of_literal_2_s_after']['value']))


def test_real_ranges_are_quoted():
    names = ('calibrated', 'gaussian', 'two_models', 'uncalibrated')
    for name, (_, rmse, median, nees) in zip(names, rows('| RMSE | median | NEES'), strict=True):
        found = REAL['labyrinth'][name]
        quoted((rmse.removesuffix(' m'), found['rmse_m']), (median.removesuffix(' m'), found['median_m']))
        quoted((nees, found['nees']))
    for robot, median, again, times in rows('robot | median'):
        found = REAL['mrclam']['robots'][robot]
        quoted((median.removesuffix(' m'), found['median_m']), (again.removesuffix(' m'), found['found_median_m']))
        assert int(times) == found['times_found']
    both = told('Mean of the medians @ m, the worst @ m.', PAGE)
    quoted(*zip(both, (REAL['mrclam'][f'{name}_m'] for name in ('mean_of_medians', 'worst_median')), strict=True))


def test_two_robots_in_phase_are_quoted():
    for name, (_, *cells) in zip(VARIANTS, rows('| RMS | worst | caught up'), strict=True):
        found = FOLLOWER[name]
        values = (found[key] for key in ('rms_deg', 'worst_deg', 'caught_up_after_s'))
        quoted(*((cell.split()[0], value) for cell, value in zip(cells, values, strict=True)))


def test_what_many_targets_take_is_quoted():
    count, rate, share = told('with @ targets at @ Hz each, in the graph of a replay, takes @ of a core', PAGE)
    assert (int(count), float(rate)) == (LIVE['targets'], LIVE['hertz'])
    quoted((share, LIVE['share_of_a_core']))
    assert LIVE['share_of_a_core'] < 0.5

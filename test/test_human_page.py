"""docs/human.md, and README.md, quote the figures that are committed beside them."""

import re
from functools import partial

from live import ROOT
from quotes import page, quoted, results, table, texts, told

PAGE = page('human')
STUDIES = results('human')['studies']
RADIO = results('real_radio')['studies']
DANIS, LEFT_OUT, FLAT = (RADIO[name] for name in ('danis_human', 'danis_human_left_out', 'kolakowski_human'))
rows = partial(table, PAGE)
REACHED = {what: texts(cell) for what, cell, _ in rows('what | reached')}
RUNGS = {
    'one curve, normal noise of 6 dB': 'one_curve_normal',
    'Student-t': 'student_t',
    'and offsets that drift: as configured': 'as_configured',
    'legs and pauses instead of a random walk': 'tried_walk',
    "a body's two curves, no offsets": 'tried_body',
    '200 particles': 'tried_200_particles',
}


def reached(begin):
    """The numbers of the row that begins so."""
    (found,) = [numbers for what, numbers in REACHED.items() if what.startswith(begin)]
    return found


def same(words, *values):
    """That the numbers are these, one by one."""
    quoted(*zip(words, values, strict=True))


def value(study, *names):
    """A figure of a study."""
    found = STUDIES[study]
    for name in names:
        found = found[name]
    return found['value']


def test_the_documents_scenarios_are_quoted():
    mean = partial(value, 'profiles')
    same(reached('c_walk'), mean('paper_max_of_rss_mcl'), mean('rmse_m_paper_max'), mean('rmse_m_rss_mcl'))
    same(reached('`improved` of `paper_max`'), mean('improved_of_paper_max'), mean('rmse_m_improved'))
    same(reached('`improved` of `rss_mcl`'), mean('improved_of_rss_mcl'))
    same(reached('`improved` 3 s later'), mean('lagged_of_improved'), mean('rmse_m_lagged'))
    c = partial(value, 'circle')
    same(reached('c_circle'), c('paper_direction_of_rss_mcl'), c('rmse_m_paper_direction'), c('rmse_m_improved'))
    for particles in (200, 50):
        kept = STUDIES['corridor'][f'particles_{particles}']
        both = (kept[f'rmse_m_{name}']['value'] for name in ('paper_direction', 'rss_mcl'))
        found = reached(f'c_corridor, 100 walks, {particles}')
        same(found, kept['paper_direction_of_rss_mcl']['value'], *both, kept['median_walk'])


def test_spacing_and_noise_are_quoted():
    spacing = STUDIES['spacing']
    order = sorted(
        (key for key in spacing if key.endswith('_m')), key=lambda key: float(key.removesuffix('_m')), reverse=True
    )
    others = [spacing[key]['rmse_m_rss_mcl']['value'] for key in order]
    same(reached('c_spacing'), *(spacing[key]['rmse_m_paper_max']['value'] for key in order), min(others), max(others))
    noise = STUDIES['noise']
    levels = sorted((key for key in noise if key.endswith('_dB')), key=lambda key: float(key.removesuffix('_dB')))
    same(reached('c_noise'), *(noise[key]['rmse_m_paper_max']['value'] for key in levels))
    same(reached('`rss_mcl`, worst'), noise['rss_mcl_most_of_least'])


def test_parts_of_the_model_are_quoted():
    part = partial(value, 'parts')
    same(reached('resampled as printed'), part('resampling', 'inverted_of_paper_max'))
    same(reached('lag of a disc'), *(value('disc_lag', f'{v}_m_s', 'lag_of_law') for v in ('0.5', '1', '1.5')))
    body = (part('body_turned_30_deg', name) for name in ('improved_of_paper_max', 'improved_of_without_yaw'))
    same(reached('body that turns'), *body)
    gross = (part('outliers_10_percent', name) for name in ('improved_of_without_mass', 'rmse_m_improved'))
    same(reached('10 % outliers'), *gross)
    jump, needless, silence = (STUDIES[name] for name in ('teleport', 'needless', 'silence'))
    found = (jump['reset']['median_s'], jump['median_of_no_reset'], jump['reset']['slowest_tenth_s'])
    same(reached('target that jumps'), *found)
    gross = needless['outliers_10_percent']  # the share of outliers is told between
    rates = (needless['no_outliers']['median_beyond_2.6'], 10.0, gross['median_beyond_2.6'], gross['mean_beyond_2.6'])
    same(reached('drawn anew without need'), *rates)
    worst = (silence['error_m_3_s_later']['value'], silence['runs'], silence['worst_m_3_s_later'])
    same(reached('error 3 s after'), *worst)


def test_real_signal_strengths_are_quoted():
    lines = {what: cells for what, *cells in rows('danis, four tracks pooled')}
    for what, rung in RUNGS.items():
        for channel, (filtered, later, nees) in zip(('path_loss', 'radio_map'), halves(lines[what]), strict=True):
            found = DANIS[channel][rung]
            quoted((texts(filtered)[0], found['human']['rmse_m']), (texts(later)[0], found['human_lag']['rmse_m']))
            quoted((nees, found['human']['nees']))
    for what, kept, names in (
        ('five seeds of the draws', {c: DANIS[c]['seeds'] for c in ('path_loss', 'radio_map')}, ('least_m', 'most_m')),
        ('each track with the setting that the other three choose of 27', LEFT_OUT, ('rmse_m',)),
        ('the worst of these 27', LEFT_OUT, ('most_m',)),
    ):
        for channel, (*cells, _) in zip(('path_loss', 'radio_map'), halves(lines[what]), strict=True):
            for output, cell in zip(('human', 'human_lag'), cells, strict=True):
                same(texts(cell), *(kept[channel][output][name] for name in names))
    for name, (_, *cells) in zip(('as_imported', 'path_loss', 'radio_map'), rows('kolakowski, robot'), strict=True):
        outputs = [
            FLAT[f'{name}{walls}'][output]['rmse_m'] for walls in ('', '_walls') for output in ('human', 'human_lag')
        ]
        same([texts(cell)[0] for cell in cells], *outputs)
    left = LEFT_OUT['path_loss']['human']['rmse_m'] - DANIS['path_loss']['as_configured']['human']['rmse_m']
    quoted((told('leaving a track out costs @ m', PAGE)[0], left))


def halves(cells):
    """Path loss and radio map: filtered, later, NEES."""
    return cells[:3], cells[3:]


def test_the_readme_says_the_same():
    readme = (ROOT / 'README.md').read_text('utf-8')
    lines = re.findall(r'^\| danis, particle filter.*\n\| the same.*$', readme, re.MULTILINE)[0].split('\n')
    for channel, line in zip(('path_loss', 'radio_map'), lines, strict=True):
        *_, rmse, nees = (cell.strip() for cell in line.strip('|').split('|'))
        found = DANIS[channel]['as_configured']
        same(texts(rmse), found['human']['rmse_m'], found['human_lag']['rmse_m'])
        quoted((nees, found['human']['nees']))

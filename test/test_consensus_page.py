"""docs/consensus.md quotes the figures that are committed beside it."""

from functools import partial

from quotes import page, quoted, results, table, texts, told

PAGE = page('consensus')
TABLES = results('consensus')['tables']
LIVE = results('live')['studies']['consensus']['rows']
ROWS = {name: {row['name']: row for row in rows} for name, rows in TABLES.items()}
rows = partial(table, PAGE)


def test_schemes_are_quoted():
    for name, rmse, of_cm, nees, messages, sent, share in rows('scheme | RMSE'):
        found = ROWS['schemes'][name.partition(' (')[0]]
        quoted((rmse, 100 * found['rmse_m']), (of_cm, found['rmse_of_cm_20']), (nees, found['nees']))
        quoted((messages, found['messages']), (sent, found['bytes_nominal']))
        quoted((share.removesuffix(' %'), 100 * found['bytes_of_cm_20']))
    five, cm = ROWS['schemes']['flood, 5 hops'], ROWS['schemes']['cm, L = 20']
    error, share = told('20 rounds of `cm` (@ of its error) at @ % of its bytes', PAGE)
    quoted((error, five['rmse_m'] / cm['rmse_m']), (share, 100 * five['bytes_of_cm_20']))
    ten = [ROWS['ten_bytes'][f'flood of {what}, 5 hops'] for what in ('readings in ten bytes', 'information')]
    words = told('that gives @ cm against @, NEES @ against @', PAGE)
    values = (*(100 * row['rmse_m'] for row in ten), *(row['nees'] for row in ten))
    quoted(*zip(words, values, strict=True))
    one = ROWS['schemes']['flood, 1 hops']
    words = told('at one hop the mean NEES is @, that of the median run @.', PAGE)
    quoted(*zip(words, (one['nees'], one['nees_median_run']), strict=True))


def test_faults_are_quoted():
    for reads, *cells in rows('it reads'):
        for model, cell in zip(('uniform', 'zero', 'absent'), cells, strict=True):
            (number,) = texts(cell)
            rmse = ROWS['faults'][f'{reads} faults, {model} model']['rmse_m']
            quoted((number, rmse if cell.endswith(' m') else 100 * rmse))
    words = told('in @ % (zero) and @ % (clutter) of all node-epochs', PAGE)
    found = (100 * ROWS['faults'][f'{kind} faults, uniform model']['mode_accuracy'] for kind in ('zero', 'clutter'))
    quoted(*zip(words, found, strict=True))


def test_links_are_quoted():
    for scheme, *cells, death in rows('scheme | none lost'):
        lost = (100 * ROWS['links'][f'{scheme}, {share}% lost']['rmse_m'] for share in (0, 30, 50))
        quoted(*zip(cells, lost, strict=True))
        quoted((death, ROWS['deaths'][scheme]['ratio_together']))


def test_deaths_that_part_a_field_are_quoted():
    cm = ROWS['deaths']['cm']
    cut_off = [key for key in cm if key.startswith('cut_off')]
    words = told('over @ deaths', PAGE) + told('@ of these deaths part the field, and cut off @ nodes, @ % of', PAGE)
    of_cut_off = (sum(cm[key] for key in cut_off), 100 * cm['share_cut_off'])
    quoted(*zip(words, (cm['deaths'], cm['parting'], *of_cut_off), strict=True))
    words = told('has an error of @ m from then on, in a part of two to four @ m, of five or more @ m', PAGE)
    quoted(*zip(words, (cm[key.replace('cut_off', 'rmse_m')] for key in cut_off), strict=True))
    words = told('outweigh everybody else, @ times', PAGE) + told(
        'not, @ % cost at most a tenth, the median one @ %', PAGE
    )
    ratios = (cm['ratio_all'], 100 * cm['share_up_to_1.1'], 100 * (cm['median_ratio'] - 1))
    quoted(*zip(words, ratios, strict=True))


def test_parts_are_quoted():
    sizes = ('alone', 'two_to_four', 'five_or_more')
    found = ROWS['parts']
    words = told('a node is alone (@ %), one of two to four (@ %), or of five or more (@ %)', PAGE)
    shares = (100 * found['uniform model, w = 8'][f'share_{size}'] for size in sizes)
    quoted(*zip(words, shares, strict=True))
    cells = rows('loss model, w')
    assert len(cells) == len(found)
    for name, *values, tests in cells:
        model, w = name.removesuffix(' (default)').split(', ')
        row = found[f'{model} model, w = {w}']
        columns = (row['nees'], *(row[f'nees_{size}'] for size in sizes))
        columns += (row['rmse_m'], *(row[f'rmse_m_{size}'] for size in sizes))
        quoted(*zip(values, columns, strict=True))
        quoted((tests.removesuffix(' %'), 100 * row['batches_up_to_5']))
    plain = ROWS['schemes']['cm, L = 20, w = 1']
    words = told('`cm` with L = 20 has @ cm and NEES @ with w = 1 and with w = 8', PAGE)
    for row in (plain, ROWS['schemes']['cm, L = 20']):
        quoted(*zip(words, (100 * row['rmse_m'], row['nees']), strict=True))
    words = told('No consensus at all has @ m and NEES @ with w = 1, @ m and @ with w = 8', PAGE)
    pair = [ROWS['schemes'][f'no consensus{w}'] for w in (', w = 1', '')]
    quoted(*zip(words, (row[key] for row in pair for key in ('rmse_m', 'nees')), strict=True))


def test_growth_is_quoted():
    for nodes, neighbours, diameter, icf, flood, *sent in rows('nodes | neighbours'):
        found = ROWS['scaling'][f'{nodes} nodes']
        quoted((neighbours, found['neighbours']), (diameter, found['diameter']))
        for scheme, us, many in zip(('icf_20', 'flood_5'), (icf, flood), sent, strict=True):
            quoted((us, found[f'us_a_node_epoch_{scheme}']), (many, found[f'bytes_nominal_{scheme}']))


def test_fifty_live_nodes_are_quoted():
    for found, (scheme, *cells, over, differ) in zip(LIVE, rows('scheme | median'), strict=True):
        assert scheme.startswith(found['scheme'])
        times = (found[key] for key in ('median_s', 'q95_s', 'longest_s'))
        quoted(*((cell.removesuffix(' s'), value) for cell, value in zip(cells, times, strict=True)))
        assert over.replace('none', '0') == f'{found["over"]} of {found["epochs"]}'
        assert differ.replace('none', '0') == f'{found["differing"]} of {found["compared"]}'

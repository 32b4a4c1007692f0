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
    links = ROWS['links']
    for scheme, *cells, death in rows('scheme | none lost'):
        lost = (100 * links[f'{scheme}, {share}% lost']['rmse_m'] for share in (0, 30, 50))
        quoted(*zip(cells, lost, strict=True))
        survived = links[f'{scheme}, the same, where that parts nobody (99 runs)']['rmse_m']
        quoted((death, survived / links[f'{scheme}, the same runs without a death']['rmse_m']))
    names = ('components of five or more', 'components of two to four', 'nodes alone')
    for name, (_, share, rmse, nees, median) in zip(names, rows('component'), strict=True):
        found = links[f'the same, {name}']
        quoted((share.removesuffix(' %'), 100 * found['share_of_nodes']), (rmse.removesuffix(' m'), found['rmse_m']))
        quoted((nees, found['nees']), (median, found['nees_median_run']))


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

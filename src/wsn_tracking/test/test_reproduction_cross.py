"""All systems on the same recordings: the same packets for all, one table, and what is not there is named."""

import json
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from import_cases import real_data
from reproduction_cases import HERE, SETTING, claim, figure

from wsn_tracking import cli
from wsn_tracking.errors import TrackingError
from wsn_tracking.graphs import open_bag
from wsn_tracking.reproduction import cross, reproduce
from wsn_tracking.reproduction.claims import MEASURED
from wsn_tracking.reproduction.content import content
from wsn_tracking.reproduction.cross_claims import CLAIMS
from wsn_tracking.reproduction.cross_fields import FIELDS, Ready, simulated, without_bodies
from wsn_tracking.reproduction.cross_reading import COLUMNS as READING
from wsn_tracking.reproduction.cross_reading import reading
from wsn_tracking.reproduction.cross_systems import CONTENDERS, bodiless, measured
from wsn_tracking.reproduction.cross_table import COLUMNS, table
from wsn_tracking.reproduction.page import page
from wsn_tracking.sensing.values import Rssi

BY_NAME = {field.name: field for field in FIELDS}
LOOP = BY_NAME['a_loop']
A_LOOP = Path(__file__).resolve().parents[3] / 'bags' / 'a_loop'


def shortened(source, recording, epochs):
    """The first epochs of a recording."""

    def epoch(message):
        return message.request_seq if hasattr(message, 'request_seq') else message.seq

    return source, recording._replace(messages=tuple(m for m in recording.messages if epoch(m) < epochs))


@pytest.fixture(scope='module')
def samples():
    """Two recordings of forty epochs of a_loop, for all but B, which takes longer than all others together."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(cross, 'simulated', lambda name, seed: shortened(*simulated(name, seed), 40))
        patch.setattr(cross, 'CONTENDERS', [c for c in CONTENDERS if c.name != 'B'])
        return cross.recorded(LOOP, 3, 2)


@pytest.fixture(scope='module')
def full(samples):
    """The same with a B that is as E."""
    of_e = {key: value for key, value in samples.items() if key.removeprefix(MEASURED).startswith(('E ', 'E:'))}
    return {**samples, **{key.replace('E', 'B', 1): value for key, value in of_e.items()}}


def test_every_contender_is_scored_whole_and_with_losses(samples):
    for contender in CONTENDERS:
        if contender.name != 'B':
            for rate in cross.RATES:
                squares = samples[f'{contender.name} {rate:g}: squares']
                assert squares.shape == (2,)
                assert np.all((squares > 0.0) & (squares < 4.0))  # [m^2] the field is 3.6 x 2.4 m
            assert np.all(samples[f'{MEASURED}{contender.name}: cpu'] > 0.0)


def test_the_same_seed_gives_the_same_but_for_what_is_measured(samples, monkeypatch):
    monkeypatch.setattr(cross, 'simulated', lambda name, seed: shortened(*simulated(name, seed), 40))
    monkeypatch.setattr(cross, 'CONTENDERS', [c for c in CONTENDERS if c.name in ('A', 'C', 'nearest')])
    again = cross.recorded(LOOP, 3, 2)
    for name, values in again.items():
        assert name.startswith(MEASURED) or np.array_equal(values, samples[name], equal_nan=True), name
    assert not np.array_equal(again['C 0: squares'][:1], again['C 0: squares'][1:])


def test_what_is_lost_makes_nobody_better(samples):
    for name in ('A', 'centre', 'C', 'D', 'E', 'fix', 'nearest'):
        errors = [samples[f'{name} {rate:g}: squares'].mean() for rate in cross.RATES]
        assert errors[0] < errors[-1], name


def test_a_node_sends_what_it_measures(samples):
    """Twelve nodes, twelve messages of 18 bytes; A's trigger saves more messages than its three estimates cost."""
    assert samples['centre: messages'] == pytest.approx(12.0)
    assert samples['E: bytes'] == pytest.approx(12.0 * 18.0)
    assert np.all(samples['A: messages'] < 12.0)


def test_consensus_is_compared_as_well():
    """Twelve nodes, three rounds: 36 messages an epoch."""
    consensus = next(c for c in CONTENDERS if c.name == 'B')
    told = cross.followed(consensus, LOOP, [shortened(*simulated('a_loop', 5), 15)], 5.0, 1)
    assert told['messages'] == pytest.approx(36.0)
    assert told['squares'] < 0.1


def test_the_simulated_recording_is_the_bag_of_its_seed():
    bag = open_bag(str(A_LOOP))[1]
    made = simulated('a_loop', 1)[1]
    read, drawn = (
        [(m.request_seq, m.node_id, m.rssi_dbm) for m in r.messages if isinstance(m, Rssi)] for r in (bag, made)
    )
    assert read == drawn
    assert len(read) == 12 * 120


def test_who_knows_no_bodies_takes_signal_strengths_for_less_certain():
    source, recording = simulated('c_walk', 1)
    given = bodiless((source, recording), BY_NAME['c_walk'].facts)[1]
    assert np.all(given.anchors.sigma_db == 7.2)
    assert all(np.isnan(m.sigma_db) for m in given.messages if isinstance(m, Rssi))
    assert measured((source, given), 1) == measured((source, recording), 1)
    assert bodiless((source, recording), LOOP.facts)[1] is recording
    assert len(without_bodies(recording, 5.0).messages) == len(recording.messages)


# ---- the table


@pytest.fixture(scope='module')
def plain(full):
    """The table of both kinds of recordings."""
    one = {name: values[:1] for name, values in full.items()}
    return table(
        {'x a_loop': full, 'x lias': one}, 'made so', {'danis': 'not here.', 'zignav': 'not here.', 'mrclam': 'no.'}
    )


def test_the_table_has_a_row_for_every_system_on_every_recording(plain):
    assert Counter(row[0] for row in plain['rows']) == {'a_loop': len(CONTENDERS), 'lias': len(CONTENDERS)}
    assert all(len(row) == len(COLUMNS) for row in plain['rows'])
    assert len(plain['measured']['CPU [ms]']) == len(plain['rows'])
    json.dumps(plain, allow_nan=False)


def test_recordings_that_are_not_there_are_named(plain):
    assert 'Not run: `danis`, `zignav`: not here. Not run: `mrclam`: no.' in plain['text'][-1]


def test_only_simulated_recordings_have_an_interval(plain):
    intervals = {row[0]: row[COLUMNS.index('95 % interval')] for row in plain['rows']}
    assert ' to ' in intervals['a_loop']
    assert intervals['lias'] == ''


def test_the_page_shows_the_table(plain):
    content_ = {**SETTING._asdict(), 'claims': [claim_of_page()], 'tables': [plain]}
    text = page(content_)
    assert '<section id="cross">' in text
    assert 'CPU [ms]' in text
    assert text.count('<td>a_loop</td>') == len(CONTENDERS) + 1  # and in what it amounts to


def claim_of_page():
    more = {'document': 'X', 'place': 'p', 'statement': 's', 'remark': '', 'plots': [], 'runs': 1, 'command': 'c'}
    return {**claim(figure((0.5, 0.6), shape=[0.0, 1.0]), kind='beyond'), **more}


def test_statements_follow_from_the_samples(full):
    found = content(CLAIMS, dict.fromkeys(('x a_loop', 'x c_walk'), full), SETTING)
    shown = {c['id']: c for c in found['claims']}
    assert [f['name'] for f in shown['X1']['figures']][:2] == ['RMSE, centre / fix', 'RMSE, A / fix']
    assert found['verdicts']['X2'] != 'holds'  # on a_loop, where no body is in the way


# ---- real recordings


def test_recordings_are_run_where_they_are_and_named_where_not(tmp_path, monkeypatch):
    """A folder with one set in it."""
    data = tmp_path / 'data'
    data.mkdir()
    seen = []

    def bags(name, folder, work):
        seen.append((name, folder))
        if name != 'danis':
            raise TrackingError(f'no {name}')
        return Ready((str(A_LOOP),), 5.0)

    monkeypatch.setattr(cross, 'real_bags', bags)
    ready, absent = cross.prepared(data, tmp_path)
    assert set(ready) == {'danis'}
    assert absent == {field.name: f'no {field.name}' for field in FIELDS if field.real and field.name != 'danis'}
    monkeypatch.setattr(cross, 'CONTENDERS', [c for c in CONTENDERS if c.name in ('centre', 'nearest')])
    (experiment,) = cross.on_recordings(ready)
    found = experiment.sample(3, 1)
    assert found['centre 0: squares'] < found['nearest 0: squares']


@pytest.mark.parametrize(
    ('folder', 'name', 'skip_s'), [('labyrinth_uwb', 'labyrinth', 10.0), ('zignav_zigbee_log', 'zignav', 5.0)]
)
def test_real_recordings_are_imported_and_calibrated_where_they_can_be(tmp_path, folder, name, skip_s):
    """The first is calibrated from the part that is not scored, the second not at all."""
    ready = cross.real_bags(name, real_data(folder).parent, tmp_path)
    assert ready.skip_s == skip_s
    (bag,) = ready.bags
    anchors = open_bag(bag)[1].anchors
    assert np.any(anchors.bias != 0.0) == (name == 'labyrinth')


def test_a_folder_that_is_none_is_refused_in_one_line(tmp_path, capsys):
    with pytest.raises(SystemExit) as ended:
        cli.main(['reproduce', 'X', '--data', str(tmp_path / 'none'), '-o', str(tmp_path / 'o')])
    assert ended.value.code == 1
    assert 'is no folder' in capsys.readouterr().err


def test_a_folder_without_any_recording_is_refused_before_the_work(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(reproduce, 'run', lambda *_, **__: pytest.fail('it works for nothing'))
    with pytest.raises(SystemExit) as ended:
        cli.main(['reproduce', 'X', '--data', str(tmp_path), '-o', str(tmp_path / 'o')])
    assert ended.value.code == 1
    told = capsys.readouterr().err
    assert 'holds no recording that can be used' in told
    assert told.count('\n') == 1


def test_what_is_absent_is_told_by_the_name_that_the_command_gives_the_folder(tmp_path, monkeypatch):
    def bags(name, folder, work):
        if name != 'danis':
            raise TrackingError(f'{folder} has no {name}')
        return Ready((str(A_LOOP),), 5.0)

    monkeypatch.setattr(cross, 'real_bags', bags)
    assert cross.prepared(tmp_path, tmp_path)[1]['lias'] == 'DATA has no lias'


def test_without_a_folder_every_real_recording_is_named_as_absent(monkeypatch, full):
    monkeypatch.setattr(reproduce, 'run', lambda experiments, *_, **__: {e.name: full for e in experiments})
    found = reproduce.computed(CLAIMS, SETTING, HERE)
    text = found['tables'][0]['text'][-1]
    names = ', '.join(f'`{field.name}`' for field in FIELDS if field.real)
    assert f'Not run: {names}: no folder' in text
    assert found['tables'][0]['command'] == './wsn-tracking reproduce X --seed 31 --quick'


# ---- what the table amounts to


def rows_of(*systems):
    """A table of one recording: system, RMSE, NEES, bytes."""
    columns = ['recording', 'system', 'RMSE [m]', 'NEES (of 2)', 'bytes']
    return {'columns': columns, 'rows': [['here', *system] for system in systems]}


def test_what_the_table_amounts_to_follows_from_its_rows():
    table_ = rows_of(('a', 1.1, 2.0, 30.0), ('b', 1.0, 0.5, 20.0), ('c', 1.5, 4.0, 5.0), ('d', 2.1, None, 1.0))
    assert reading(table_) == [['here', 'b', 1.0, 'a', 'd', 'a; c', 'b']]


def test_who_has_lost_its_target_for_good_is_no_part_of_what_it_amounts_to():
    assert reading(rows_of(('a', None, None, 1.0), ('b', 3.0, None, 2.0))) == [['here', 'b', 3.0, '', '', '', 'b']]


def test_every_recording_amounts_to_something(plain):
    found = reading(plain)
    assert [row[0] for row in found] == ['a_loop', 'lias']
    assert all(len(row) == len(READING) for row in found)
    assert all(cell for row in found for cell in (row[1], row[-1]))

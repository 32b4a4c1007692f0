"""Channel files: what is written comes back, what is broken is refused in one line."""

from __future__ import annotations

import numpy as np
import pytest
from channel_cases import GOOD, a_channel, changed

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.radio_map import residual
from wsn_tracking.sensing.channel_file import check_channel, load_channel, save_channel
from wsn_tracking.sensing.channel_parse import parse_channel
from wsn_tracking.sensing.channel_text import channel_text


def flattened(value):
    if isinstance(value, tuple):
        return [part for each in value for part in flattened(each)]
    return [] if value is None else [np.asarray(value)]


def test_what_is_saved_comes_back(tmp_path):
    channel = a_channel()
    path = tmp_path / 'new' / 'channel.yaml'
    save_channel(path, channel)
    back = load_channel(path)
    assert back.origin == channel.origin
    for ours, theirs in zip(flattened(channel[:3]), flattened(back[:3]), strict=True):
        np.testing.assert_allclose(theirs, ours, rtol=1e-5, atol=1e-9)
    x = np.random.default_rng(1).uniform(0.0, 8.0, (50, 4))
    np.testing.assert_allclose(residual(back.radio_map, x), residual(channel.radio_map, x), atol=1e-3)
    assert back.radio_map.residual_db.shape == (25, 3)
    assert np.isnan(back.radio_map.residual_db[3, 1])


def test_a_file_that_was_read_is_written_unchanged():
    text = channel_text(a_channel())
    assert channel_text(parse_channel(text, 'x')) == text


def test_places_in_the_grid_of_a_country_are_written_to_the_millimetre():
    channel = a_channel()
    away = channel.radio_map._replace(points=np.add(channel.radio_map.points, [4.5e5, 5.4e6]))
    back = parse_channel(channel_text(channel._replace(radio_map=away)), 'x')
    np.testing.assert_allclose(back.radio_map.points, away.points, rtol=0.0, atol=0.5e-3 + 1e-9)


@pytest.mark.parametrize('map_too', [True, False])
@pytest.mark.parametrize('ranging', [True, False])
def test_parts_may_be_absent(map_too, ranging):
    back = parse_channel(channel_text(a_channel(map_too, ranging)), 'x')
    assert (back.radio_map is not None) == map_too
    assert (back.ranging is not None) == ranging
    ranges = a_channel()._replace(path_loss=None, radio_map=None)
    assert parse_channel(channel_text(ranges), 'x').path_loss is None


def test_saving_is_whole_or_not_at_all(tmp_path):
    path = tmp_path / 'channel.yaml'
    path.write_text('before')
    save_channel(path, a_channel(map_too=False))
    assert path.read_text().startswith('# Radios')
    assert [p.name for p in tmp_path.iterdir()] == ['channel.yaml']
    (tmp_path / 'file').write_text('')
    with pytest.raises(TrackingError, match='cannot be written'):
        save_channel(tmp_path / 'file' / 'channel.yaml', a_channel(map_too=False))


@pytest.mark.parametrize(
    ('text', 'said'),
    [
        ('', '`format` is .NoneType'),
        ('hello', '`format`'),
        ('[1, 2]', '`format`'),
        ('{', 'no readable YAML'),
        ('format: wsn_tracking channel 2', "`format` is 'wsn_tracking channel 2'"),
        ('format: wsn_tracking channel 1', 'neither `path_loss` nor `ranging`'),
        (GOOD + 'extra: 1\n', 'sections'),
        (changed('origin:.*?# Signal', 'origin: 3\n# Signal'), '`origin` is 3'),
        (changed('path_loss:.*?# Range', 'path_loss: 3\n# Range'), '`path_loss` is 3'),
        (changed('path_loss:.*?# Range', '# Range'), '`map` without `path_loss`'),
        (changed(r'\n  20: \{p1', r'\n  21: {p1'), 'of different nodes'),
        (changed(r'\n  3: \{p1', r'\n  -3: {p1'), 'ids from 0 to 65535'),
        (changed(r'\n  3: \{p1', r'\n  70000: {p1'), 'ids from 0 to 65535'),
        (changed(r'\n  3: \{p1', r'\n  x: {p1'), 'ids from 0 to 65535'),
        (changed(r'\n  3: \{p1_dbm', r'\n  3: {p2_dbm'), 'values of p1_dbm, n, sigma_db'),
        (changed(r'\n  3: \{p1[^\n]*', r'\n  3: []'), 'values of p1_dbm'),
        (changed(r' n: \[[^]]*', ' n: [.nan, 0.1, 1.0, 3.0'), '`n` of node 3'),
        (changed(r' n: \[[^]]*', ' n: [2.0, 0.1, 1.0'), '4 finite numbers'),
        (changed(r' n: \[[^]]*', ' n: [-2.0, 0.1, -3.0, -1.0'), 'a value from 0.01 to 20'),
        (changed(r' n: \[[^]]*', ' n: [2.0, -0.1, 1.0, 3.0'), 'with a standard deviation'),
        (changed(r' n: \[[^]]*', ' n: [2.0, 0.1, 3.0, 4.0'), 'within its interval'),
        (changed(r' n: \[[^]]*', ' n: [true, 0.1, 0.0, 4.0'), '4 finite numbers'),
        (changed(r'sigma_db: \[[^]]*', 'sigma_db: [0.0, 0.0, 0.0, 0.0'), '`sigma_db` of node 3'),
        (changed(r'scale: \[[^]]*\]', 'scale: 3'), '`scale` of node 3 is 3'),
        (changed('places: 25', 'places: -1'), '`places` of node 3 is -1'),
        (changed(r'readings: \d+', 'readings: 1.5'), '`readings` of node 3 is 1.5'),
        (changed('amplitude_db: [^\n]*', 'amplitude_db: -1.0'), 'amplitude_db >= 0'),
        (changed('length: [^\n]*', 'length: 0.0'), 'length > 0'),
        (changed('length: [^\n]*', 'length: far'), '2 finite numbers'),
        (changed('  length: [^\n]*\n', ''), '`map` holds'),
        (changed('map:.*', 'map: 7\n'), '`map` holds 7'),
        (changed(r'    7: \[[^\n]*\n', ''), 'of nodes .3, 20.'),
        (changed(r'    7: \[[^\n]*', r'    7: [-50.0, 2.0, -1.0, 2.0]'), 'place_db >= 0'),
        (changed(r'residual_db: \|\n    \S+', 'residual_db: |\n    1e999'), 'infinite'),
        (changed(r'residual_db: \|\n    \S+', 'residual_db: |\n    -'), 'different places'),
        (changed(r'residual_db: \|\n    \S+', 'residual_db: |\n    x'), 'residual_db. of `map`: could not convert'),
        (changed(r'residual_db: \|\n    \S+ ', 'residual_db: |\n    '), 'rows of 5 numbers'),
        (changed(r'noise_db: \|\n[^\n]*\n', 'noise_db: |\n'), 'different places'),
        (changed('noise_db: .*', 'noise_db: 5\n'), '`noise_db` of `map` has 0 rows'),
        (changed(r'(noise_db: \|\n    \S+ \S+) \S+', r'\1 0.0'), 'noise_db >= 1e-6'),
    ],
)
def test_broken_files_are_refused_in_one_line(tmp_path, text, said):
    path = tmp_path / 'channel.yaml'
    path.write_text(text)
    with pytest.raises(TrackingError, match=said) as error:
        load_channel(path)
    assert 'channel.yaml' in str(error.value)
    assert '\n' not in str(error.value)
    assert len(str(error.value)) < 500


@pytest.mark.parametrize('where', ['absent.yaml', '.', 'binary'])
def test_what_is_no_text_is_refused(tmp_path, where):
    (tmp_path / 'binary').write_bytes(b'\xff\xfe\x00')
    with pytest.raises(TrackingError, match='cannot be read'):
        check_channel(str(tmp_path / where))
    check_channel('')


def test_places_without_end_are_refused():
    rows = '\n'.join(f'    {i} 0.0 1.0 1.0 1.0' for i in range(5001))
    text = changed(r'residual_db: \|.*', f'residual_db: |\n{rows}\n  noise_db: |\n{rows}\n')
    with pytest.raises(TrackingError, match='5001 rows; expected 1 to 5000'):
        parse_channel(text, 'x')

"""calibrate --body: the file of a body, and who uses it."""

import numpy as np
import pytest
from worn_cases import ANCHORS, KNOWN, measured, walked

from wsn_tracking.bags.read import read
from wsn_tracking.bags.save import save
from wsn_tracking.errors import TrackingError
from wsn_tracking.models.body import LOS, SINGLE
from wsn_tracking.sensing.body_fit import fit_worn
from wsn_tracking.sensing.channel import Body, Quantity
from wsn_tracking.sensing.channel_file import body_of, load_channel, save_channel
from wsn_tracking.simulation.c_body import BodyConfig
from wsn_tracking.simulation.record import record
from wsn_tracking.simulation.scenarios import scenario
from wsn_tracking.surveys import open_walk
from wsn_tracking.trackers.human_config import HumanConfig, SignalConfig
from wsn_tracking.trackers.human_models import curves_of


def of(line):
    return None if line is None else Quantity(*(np.array([v, v / 2]) for v in (line, 0.5, line - 1.0, line + 1.0)))


@pytest.mark.parametrize('sides', [True, False])
def test_a_body_survives_its_file(tmp_path, sides):
    loss = Quantity(*(np.array([v]) for v in (-6.5, 0.5, -7.5, -5.5)))
    body = Body(loss, of(4.0) if sides else None, of(-4.0) if sides else None, 3.25, (100, 200 if sides else 0))
    save_channel(tmp_path / 'c.yaml', KNOWN._replace(body=body))
    back = body_of(str(tmp_path / 'c.yaml'))
    np.testing.assert_allclose(back.loss.value, [-6.5])
    assert (back.sigma_db, back.readings) == (3.25, body.readings)
    assert (back.los is None) is not sides
    if sides:
        np.testing.assert_allclose(back.los.value, [4.0, 2.0])
        np.testing.assert_allclose(back.nlos.high, [-3.0, -1.5])
    save_channel(tmp_path / 'none.yaml', KNOWN)
    assert body_of(str(tmp_path / 'none.yaml')) is body_of('') is None


@pytest.mark.parametrize(
    ('old', 'new', 'words'),
    [
        ('loss: [-6.5', 'loss: [-99.0', '`loss` of `body`'),
        ('sigma_db: 3.25', 'sigma_db: 0.0', '`sigma_db` of `body`'),
        ('readings: [100, 200]', 'readings: [100]', '`readings` of `body`'),
        ('readings: [100, 200]', 'readings: [100, -1]', '`readings` of `body`'),
        ('per_decade: [2.0', 'per_octave: [2.0', '`los` of `body`'),
        ('  los:', '  left:', '`body` holds'),
        ('  loss:', '  lost:', '`body` holds'),
        ('path_loss:', 'path_los:', 'sections'),
    ],
)
def test_a_body_that_is_spoilt_is_refused_with_its_place(tmp_path, old, new, words):
    loss = Quantity(*(np.array([v]) for v in (-6.5, 0.5, -7.5, -5.5)))
    path = tmp_path / 'c.yaml'
    save_channel(path, KNOWN._replace(body=Body(loss, of(4.0), of(-4.0), 3.25, (100, 200))))
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(TrackingError, match=words):
        load_channel(path)


def test_the_command_makes_a_file_that_the_tracker_takes(call, tmp_path):
    save(tmp_path / 'bag', walked(BodyConfig(duration=100.0)))
    save_channel(tmp_path / 'radios.yaml', KNOWN)
    out = tmp_path / 'worn.yaml'
    ended = call('calibrate', tmp_path / 'bag', '--body', '--channel', tmp_path / 'radios.yaml', '-o', out)
    assert ended.code == 0
    assert 'per decade' in ended.out
    channel = load_channel(out)
    assert channel.origin['survey'] == 'of a test'
    assert channel.origin['body_bag'] == 'bag'
    body = fit_worn(*measured(read(tmp_path / 'bag')), ANCHORS, KNOWN).body
    np.testing.assert_allclose(channel.body.los.value, body.los.value, rtol=1e-5)
    curves = curves_of(HumanConfig(), ANCHORS, channel.body)
    np.testing.assert_allclose(curves.los.p_ref, SINGLE.p_ref + body.los.value[0], rtol=1e-5)
    np.testing.assert_allclose(curves.nlos.k, SINGLE.k + body.nlos.value[1], rtol=1e-5)
    np.testing.assert_allclose(curves.single.p_ref, SINGLE.p_ref + body.loss.value[0], rtol=1e-5)
    given_ = curves_of(HumanConfig(signal=SignalConfig(curves='given')), ANCHORS, channel.body)
    np.testing.assert_array_equal(given_.los.p_ref, np.full(16, LOS.p_ref))


def test_a_constant_loss_shifts_every_curve():
    loss = Quantity(*(np.array([v]) for v in (-6.5, 0.5, -7.5, -5.5)))
    plain = curves_of(HumanConfig(), ANCHORS)
    worn = curves_of(HumanConfig(), ANCHORS, Body(loss, None, None, 3.0, (100, 0)))
    for before, after in zip(plain, worn, strict=True):
        np.testing.assert_allclose(after.p_ref, before.p_ref - 6.5)
        np.testing.assert_array_equal(after.k, before.k)


@pytest.mark.parametrize(
    ('arguments', 'words'),
    [
        (['--body', '--map'], '--map is of a survey'),
        (['--channel', 'x.yaml'], 'without --body'),
    ],
)
def test_options_that_make_no_sense_together_are_refused(call, tmp_path, arguments, words):
    save(tmp_path / 'bag', walked(BodyConfig(duration=10.0)))
    ended = call('calibrate', tmp_path / 'bag', *arguments, '-o', tmp_path / 'out.yaml')
    assert ended.code != 0
    assert words in ended.err
    assert not (tmp_path / 'out.yaml').exists()


def test_a_body_is_of_a_walk_and_of_signal_strengths(tmp_path):
    (tmp_path / 'survey').mkdir()
    (tmp_path / 'survey' / 'set_1.hst').write_text('')
    with pytest.raises(TrackingError, match='survey of places'):
        open_walk(tmp_path / 'survey')
    save(tmp_path / 'ranges', record(scenario('d_stop'), 1))
    with pytest.raises(TrackingError, match='holds ranges'):
        open_walk(tmp_path / 'ranges')
    save(tmp_path / 'blind', walked(BodyConfig(duration=5.0))._replace(truth={}))
    with pytest.raises(TrackingError, match='no truth'):
        open_walk(tmp_path / 'blind')

"""What docs/own_data.md tells a newcomer to do works as it stands there."""

from __future__ import annotations

import re
import shlex

import numpy as np
import pytest
import yaml

from quotes import page
from wsn_tracking import graphs
from wsn_tracking.bags.read import read
from wsn_tracking.bags.save import save
from wsn_tracking.cli import main
from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.simulation.record import record
from wsn_tracking.simulation.scenarios import scenario

PAGE = page('own_data')
YAML, STAND, TABLE = re.findall(r'```(?:yaml|python)\n(.*?)```', PAGE, re.DOTALL)
RNG = np.random.default_rng(3)


def commands(begin):
    """The commands of the page that begin so, as words."""
    return [
        shlex.split(line, comments=True)[1:] for line in PAGE.splitlines() if line.startswith(f'./wsn-tracking {begin}')
    ]


def call(words):
    """Run a command; it has to end well."""
    with pytest.raises(SystemExit) as ended:
        main(words)
    assert ended.value.code == 0, words


@pytest.fixture
def field(tmp_path, monkeypatch):
    """A folder with my_field.yaml, and a world of its nodes in which a robot stands here and there."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / 'my_field.yaml').write_text(YAML)
    told = yaml.safe_load(YAML)['/**/serial_bridge']['ros__parameters']['anchors']
    places = [(x, y, told['z'][0]) for x, y in zip(told['x'], told['y'], strict=True)]
    return make_anchors(told['ids'], places)


def stand(anchors, places, name):
    """A recording without truth of a robot that stands 20 s at each place, and drives on in 5 s."""
    times, arrived = np.arange(25.0 * len(places)), 25.0 * np.arange(len(places))
    corners = np.column_stack([arrived, arrived + 20.0]).ravel()
    states = np.zeros((times.size, 4))
    for axis in (0, 1):
        states[:, axis] = np.interp(times, corners, np.repeat(places[:, axis], 2))
    world = scenario('a_loop')._replace(anchors=anchors, truth=states, period=1.0, area=(0.0, 0.0, 6.0, 4.0))
    save(name, record(world, len(name))._replace(truth={}, metadata={'period': '1'}))
    np.savetxt('stays.csv', np.column_stack([arrived, arrived + 19.5, places]), delimiter=',')


def test_the_field_is_one_that_a_sink_can_be_tracked_in(field):
    graph = graphs.serial('my_field.yaml', settings={'channel': ''})
    assert [p.name for p in graph if p.executable == 'estimator_node'] == ['estimator_1']
    assert all(words[:2] == ['sink', 'track'] for words in commands('sink track'))


def run_script(text, **names):
    """Run a script of the page, with other names of bags in the place of its own."""
    for name, other in names.items():
        text = text.replace(f"'{name}'", f"'{other}'")
    exec(compile(text, 'docs/own_data.md', 'exec'), {})  # noqa: S102 (it is the page's own)


def test_a_robot_that_stood_at_marked_places_calibrates_and_scores(field, capsys):
    grid = np.array([(x, y) for y in (0.5, 2.0, 3.5) for x in (0.5, 1.75, 3.0, 4.25, 5.5)])
    stand(field, grid, 'walk')
    run_script(STAND)
    stand(field, grid + RNG.uniform(-0.3, 0.3, grid.shape), 'another_walk')
    run_script(STAND, walk='another_walk', surveyed='surveyed_2')
    (calibrate,) = commands('calibrate surveyed')
    call(calibrate)
    (evaluate,) = commands('evaluate surveyed_2')
    call(evaluate[: evaluate.index('--plot')])
    (row,) = re.findall(r'^local_1 .*$', capsys.readouterr().out, re.MULTILINE)
    rmse, epochs = float(row.split()[1]), int(row.split()[-1])
    assert 280 < epochs <= 300  # the stays but for the first seconds; the ways between have no truth
    assert rmse < 1.0  # whoever guesses the middle of the area is 2.1 m off


def test_a_file_of_ranges_becomes_a_bag_that_is_calibrated_and_scored(field, capsys):
    times = np.arange(0.0, 60.0, 0.1)
    places = np.stack([3 + 2 * np.cos(0.2 * times), 2.5 + 1.5 * np.sin(0.2 * times), 1.2 + 0 * times], axis=-1)
    nodes = np.array([(0, 0, 2.0), (6, 0, 2.0), (6, 5, 2.0), (0, 5, 2.0)])
    rows = [
        (t + 0.001 * k, k + 1, 0.25 + np.linalg.norm(place - node) + 0.05 * RNG.standard_normal())
        for t, place in zip(times, places, strict=True)
        for k, node in enumerate(nodes)
    ]
    np.savetxt('ranges.csv', RNG.permutation(rows), delimiter=',')
    np.savetxt('truth.csv', np.column_stack([times, places]), delimiter=',')
    run_script(TABLE)
    assert len(read('my_ranges').messages) == 600 * 6  # request, four ranges, end
    (calibrate,) = commands('calibrate my_ranges')
    call(calibrate)
    evaluate, every = commands('evaluate my_ranges')
    call(evaluate)
    (row,) = re.findall(r'^local_1 .*$', capsys.readouterr().out, re.MULTILINE)
    assert float(row.split()[1]) < 0.1  # a bias of 0.25 m is gone, 5 cm of noise are left
    assert every == [*evaluate, '--trackers', 'all']

"""Units of work: the same numbers whoever computes them."""

import sys

import numpy as np
import pytest

from wsn_tracking.errors import TrackingError
from wsn_tracking.reproduction.b_layouts import LAYOUTS
from wsn_tracking.reproduction.claims import PICTURE, Experiment
from wsn_tracking.reproduction.engine import Workers, run, unit, unit_seed

SMALL = LAYOUTS._replace(runs=20, units=5, quick=2)
ALONE = Workers(jobs=1)


def drawn(seed, runs):
    values = np.random.default_rng(seed).random((runs, 3))
    return {'values': values, f'{PICTURE}first': values[0]}


DRAWN = Experiment('drawn', drawn, runs=4, units=5, quick=2)


def equal(a, b):
    assert a.keys() == b.keys()
    return all(np.array_equal(a[name][key], b[name][key]) for name in a for key in a[name])


@pytest.mark.parametrize('workers', [Workers(jobs=2), Workers(jobs=3, backend='threading'), Workers(jobs=1)])
def test_results_do_not_depend_on_the_workers(workers):
    """By processes, threads, and here: bit for bit."""
    assert equal(run([SMALL], 7, workers=workers), run([SMALL], 7, workers=ALONE))


def test_results_do_not_depend_on_being_computed_by_a_dask_cluster_of_this_machine():
    """Processes that are begun for it."""
    pytest.importorskip('distributed', reason='Dask is not installed')
    workers = Workers(jobs=2, backend='dask')
    assert equal(run([SMALL], 7, workers=workers), run([SMALL], 7, workers=ALONE))


def test_results_do_not_depend_on_being_computed_by_a_dask_cluster():
    distributed = pytest.importorskip('distributed', reason='Dask is not installed')
    with distributed.LocalCluster(n_workers=2, processes=False, dashboard_address=None) as cluster:
        workers = Workers(jobs=2, backend='dask', scheduler=cluster.scheduler_address)
        assert equal(run([SMALL], 7, workers=workers), run([SMALL], 7, workers=ALONE))


def test_results_do_not_depend_on_what_else_is_computed():
    other = DRAWN._replace(name='other')
    together = run([other, DRAWN], 7, workers=ALONE)
    assert equal({'drawn': together['drawn']}, run([DRAWN], 7, workers=ALONE))
    assert not np.array_equal(together['drawn']['values'], together['other']['values'])


def test_quick_runs_are_the_first_of_the_full_ones():
    quick, full = (run([DRAWN], 7, quick=q, workers=ALONE)['drawn']['values'] for q in (True, False))
    assert quick.shape == (8, 3)
    assert full.shape == (20, 3)
    assert np.array_equal(quick, full[:8])


def test_units_draw_independently_and_seeds_differ():
    seeds = {unit_seed(seed, name, number) for seed in (1, 2) for name in ('a', 'b') for number in range(50)}
    assert len(seeds) == 200
    values = run([DRAWN], 7, workers=ALONE)['drawn']['values']
    assert len(np.unique(values)) == values.size


def test_of_pictures_the_first_units_is_kept():
    found = run([DRAWN], 7, workers=ALONE)['drawn']
    assert np.array_equal(found[f'{PICTURE}first'], unit(DRAWN, 7, 0).samples['values'][0])


def test_progress_is_told_unit_by_unit():
    told = []

    def progress(items, total):
        for item in items:
            told.append(total)
            yield item

    run([DRAWN, DRAWN._replace(name='other', units=1)], 7, workers=ALONE, progress=progress)
    assert told == [6] * 6


def test_two_experiments_of_one_name_are_refused():
    with pytest.raises(TrackingError, match='share a name'):
        run([DRAWN, DRAWN], 7, workers=ALONE)


def test_a_scheduler_without_dask_is_refused():
    with pytest.raises(TrackingError, match='add --backend dask'):
        run([SMALL], 7, workers=Workers(jobs=2, scheduler='tcp://127.0.0.1:1'))


@pytest.mark.parametrize(
    ('missing', 'workers', 'words'),
    [
        ('joblib', Workers(jobs=2), 'use --jobs 1'),
        ('distributed', Workers(jobs=2, backend='dask'), 'install it, or use loky'),
    ],
)
def test_a_package_that_is_missing_is_named(monkeypatch, missing, workers, words):
    monkeypatch.setitem(sys.modules, missing, None)
    with pytest.raises(TrackingError, match=words):
        run([SMALL], 7, workers=workers)


def test_without_joblib_one_worker_does_it(monkeypatch):
    monkeypatch.setitem(sys.modules, 'joblib', None)
    assert run([DRAWN], 7, quick=True, workers=ALONE)['drawn']['values'].shape == (8, 3)

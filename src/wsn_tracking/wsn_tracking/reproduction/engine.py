"""Runs the experiments: units of work, spread over cores or machines by joblib, put together in a fixed order.

A unit is keyed by seed, experiment and number, so that its draws are the same wherever and whenever it is computed,
and the units of `--quick` are the first of the full ones.
"""

from __future__ import annotations

import importlib
import os
import signal
import threading
import warnings
import zlib
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager, nullcontext
from multiprocessing import resource_tracker
from typing import Any, NamedTuple

import numpy as np

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.draws import keyed
from wsn_tracking.reproduction.claims import PICTURE, Experiment, Samples

Progress = Callable[[Iterator[Any], int], Iterator[Any]]


class Workers(NamedTuple):
    """Who computes."""

    jobs: int = 0  # processes; 0: as many as this process may use cores
    backend: str = 'loky'  # of joblib
    scheduler: str = ''  # address of a Dask scheduler; empty: one on this machine


class Done(NamedTuple):
    """A unit that is ready."""

    experiment: str
    number: int
    samples: Samples


def unit_seed(seed: int, experiment: str, number: int) -> int:
    """Seed of a unit."""
    return int(keyed(seed, zlib.crc32(experiment.encode()), number).integers(2**63))


def unit(experiment: Experiment, seed: int, number: int) -> Done:
    """Compute one unit: here, or in whatever process joblib chooses."""
    samples = experiment.sample(unit_seed(seed, experiment.name, number), experiment.runs)
    return Done(experiment.name, number, samples)


def run(
    experiments: Sequence[Experiment],
    seed: int,
    *,
    quick: bool = False,
    workers: Workers | None = None,
    progress: Progress = lambda items, total: items,
) -> dict[str, Samples]:
    """Samples of every experiment, by name; the same for any workers."""
    names = [experiment.name for experiment in experiments]
    if len(set(names)) != len(names):
        raise TrackingError(f'two experiments share a name, and so their draws: {", ".join(sorted(names))}')
    # Those with the fewest units have the longest ones: they begin, lest the last core waits for them.
    ordered = sorted(experiments, key=lambda e: e.quick if quick else e.units)
    tasks = [(e, seed, number) for e in ordered for number in range(e.quick if quick else e.units)]
    done: dict[str, dict[int, Samples]] = {name: {} for name in names}
    for ready in progress(_computed(tasks, workers or Workers()), len(tasks)):
        done[ready.experiment][ready.number] = ready.samples
    return {name: _together([units[number] for number in sorted(units)]) for name, units in done.items()}


def _together(units: Sequence[Samples]) -> Samples:
    """All runs of an experiment; of pictures the first."""
    return {
        name: units[0][name] if name.startswith(PICTURE) else np.concatenate([unit[name] for unit in units])
        for name in units[0]
    }


def _computed(tasks: Sequence[tuple[Experiment, int, int]], workers: Workers) -> Iterator[Done]:
    """Units as they come."""
    jobs = workers.jobs or len(os.sched_getaffinity(0))
    if jobs == 1 and workers.backend == 'loky':
        yield from (unit(*task) for task in tasks)
        return
    try:
        import joblib
    except ImportError as error:
        raise TrackingError(
            'several workers need joblib, which is not installed: install it or use --jobs 1'
        ) from error
    with ExitStack() as stack:
        with _deaf_to_interrupts():
            stack.enter_context(_cluster(workers, jobs))
            stack.enter_context(joblib.parallel_config(backend=workers.backend, n_jobs=jobs))
            pool = joblib.Parallel(return_as='generator_unordered', batch_size=1)
            ready = pool(joblib.delayed(unit)(*task) for task in tasks)
            stack.callback(_closed, ready)
        yield from ready


def _closed(ready: Any) -> None:
    """Let go of results that nobody waits for any more: joblib warns of them, and its thread stumbles over them."""
    hook, threading.excepthook = threading.excepthook, lambda _: None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter('ignore')
            ready.close()
    finally:
        threading.excepthook = hook


@contextmanager
def _deaf_to_interrupts() -> Iterator[None]:
    """Processes that are begun here never see Ctrl-C: who began them ends them, and each would print a traceback."""
    resource_tracker.ensure_running()  # to begin it later, as Dask does, would undo the next line
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _cluster(workers: Workers, jobs: int) -> AbstractContextManager[Any]:
    """A Dask client where Dask is asked for: of the scheduler that is named, or of a cluster on this machine."""
    if workers.backend != 'dask':
        if workers.scheduler:
            raise TrackingError(f'a scheduler is for the backend dask, not for {workers.backend}: add --backend dask')
        return nullcontext()
    try:
        distributed = importlib.import_module('distributed')  # may be absent, also for those who check types
    except ImportError as error:
        raise TrackingError(
            'the backend dask needs the package distributed, which is not installed: install it, or use loky'
        ) from error
    if workers.scheduler:
        client: AbstractContextManager[Any] = distributed.Client(workers.scheduler)
        return client
    return _local(distributed, jobs)


@contextmanager
def _local(distributed: Any, jobs: int) -> Iterator[None]:
    """A cluster of this machine, as long as it is needed."""
    cluster = distributed.LocalCluster(n_workers=jobs, threads_per_worker=1, dashboard_address=None)
    with cluster, distributed.Client(cluster):
        yield

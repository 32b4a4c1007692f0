"""All five systems, a centre and two naive baselines on the same recordings, whole and with packets lost."""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from wsn_tracking import graphs
from wsn_tracking.bags.thin import thin
from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation.run import summarise
from wsn_tracking.evaluation.score import SKIP_S
from wsn_tracking.evaluation.summary import Summary, pool_summaries
from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.links import Loss
from wsn_tracking.reproduction.claims import MEASURED, Experiment, Samples
from wsn_tracking.reproduction.cross_fields import FIELDS, Field, Opened, Ready, simulated
from wsn_tracking.reproduction.cross_fields import real as real_bags
from wsn_tracking.reproduction.cross_systems import CONTENDERS, Contender

RATES = (0.0, 0.25, 0.5)  # of lost packets


def recorded(field: Field, seed: int, runs: int) -> Samples:
    """Of a simulated recording: every run is another one."""
    drawn = np.random.default_rng(seed).integers(2**31, size=runs).tolist()
    parts = [compared(field, [simulated(field.name, s)], SKIP_S, s) for s in drawn]
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def real(field: Field, ready: Ready, seed: int, runs: int) -> Samples:
    """Of a real recording: every run loses other packets, and draws other noise and particles."""
    opened = [graphs.open_bag(bag) for bag in ready.bags]
    drawn = np.random.default_rng(seed).integers(2**31, size=runs).tolist()
    parts = [compared(field, opened, ready.skip_s, s) for s in drawn]
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def compared(field: Field, opened: Sequence[Opened], skip_s: float, seed: int) -> Samples:
    """Mean squared error [m^2] and NEES (of 2) of each contender at each rate of loss, and what an epoch costs.

    All are given the same packets. A higher rate loses the same and more.
    """
    samples: dict[str, Floats] = {}
    for rate in RATES:
        given = [(source, thin(recording, Loss(rate), seed) if rate else recording) for source, recording in opened]
        for contender in CONTENDERS:
            told = followed(contender, field, given, skip_s, seed)
            for name in ('squares', 'nees'):
                samples[f'{contender.name} {rate:g}: {name}'] = np.array([told[name]])
            if not rate:
                samples |= {f'{contender.name}: {name}': np.array([told[name]]) for name in ('messages', 'bytes')}
                samples[f'{MEASURED}{contender.name}: cpu'] = np.array([told['cpu']])
    return samples


def followed(
    contender: Contender, field: Field, opened: Iterable[Opened], skip_s: float, seed: int
) -> dict[str, float]:
    """How one contender did, over all recordings of the field and all targets in them; cpu [ms] an epoch."""
    summaries: list[Summary] = []
    spent = np.zeros(3)
    for source, recording in opened:
        for target in source.targets:
            before = time.process_time()
            outcome = contender.follow((source, recording), field.facts, target, seed)
            spent += (*outcome.sent, time.process_time() - before)
            summary = summarise(source.title, recording, outcome.run, skip_s)
            scored = {str(i): summary.outputs[name] for i, name in enumerate(outcome.outputs)}
            summaries.append(summary._replace(outputs=scored))
    scores = pool_summaries(summaries).outputs.values()
    messages, sent, cpu = spent / sum(summary.epochs for summary in summaries)
    return {
        'squares': float(np.mean([score.rmse_m**2 for score in scores])),
        'nees': float(np.mean([score.nees for score in scores])),
        'messages': float(messages),
        'bytes': float(sent),
        'cpu': 1e3 * float(cpu),
    }


def name_of(field: Field) -> str:
    """Of its experiment."""
    return f'x {field.name}'


SIMULATED: Mapping[str, Experiment] = {
    field.name: Experiment(name_of(field), partial(recorded, field), runs=1, units=units, quick=quick)
    for field, units, quick in zip(FIELDS[:2], (8, 5), (3, 2), strict=True)
}


def prepared(data: Path, work: Path) -> tuple[dict[str, Ready], dict[str, str]]:
    """The real recordings below `data`, and why others are not there."""
    if not data.is_dir():
        raise TrackingError(f'{data} is no folder: the one that holds the recordings is expected (docs/datasets.md)')
    ready, absent = {}, {}
    for field in FIELDS:
        if field.real:
            try:
                ready[field.name] = real_bags(field.name, data, work)
            except TrackingError as error:
                absent[field.name] = str(error).replace(str(data), 'DATA')  # as the command names it
    if not ready:
        raise TrackingError(
            f'{data} holds no recording that can be used, a folder each (docs/datasets.md): {absent["danis"]}'
        )
    return ready, absent


def on_recordings(ready: Mapping[str, Ready]) -> list[Experiment]:
    """The experiments on those real recordings that are there."""
    return [
        Experiment(name_of(field), partial(real, field, ready[field.name]), runs=1, units=1, quick=1)
        for field in FIELDS
        if field.name in ready
    ]

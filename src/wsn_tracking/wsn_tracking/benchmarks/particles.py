"""One step of a particle filter, 1000 particles, 16 signal strengths: ours, `particles`', Stone Soup's, a plain loop.

Every step moves the particles by a random walk, weighs them by all nodes, estimates and resamples systematically.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterable
from datetime import datetime, timedelta
from typing import Any, NamedTuple

import numpy as np

from wsn_tracking.benchmarks.rows import Row, Sizes, at_least, cpu_seconds
from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.body import LEAST_DISTANCE, LOS, NLOS, SINGLE, Curve, Curves, mean_rssi
from wsn_tracking.models.body_likelihood import Readings
from wsn_tracking.simulation.c_body import BodyConfig, nodes
from wsn_tracking.trackers.human_config import HumanConfig, MotionConfig, ResamplingConfig, SignalConfig, StartConfig
from wsn_tracking.trackers.human_filter import HumanFilter

GROUP, WORK = 'particles', 'PF step, 1000 particles, 16 nodes'
PARTICLES, PERIOD, STEP, SIGMA = 1000, 0.5, 0.6, 3.0  # -, s, m/sqrt(s), dB
GOALS = {  # of ours, by curves and peer
    1: {'particles': 6.0, 'Stone Soup': 4.0, 'plain loop': 60.0},
    2: {'particles': 4.0, 'plain loop': 60.0},
}
EPOCHS = 10_000  # that a peer is given in advance

Mean = tuple[float, float]
Step = Callable[[], Mean]


class Problem(NamedTuple):
    """What every contender is given."""

    positions: Floats  # (16, 2)
    area: tuple[float, float, float, float]
    z: Floats  # (16,) [dBm]
    curves: tuple[Curve, ...]  # one, or two of which the likelier counts
    start: Floats  # (2, 1000)


def problem(curves: int = 1, seed: int = 1) -> Problem:
    """Somebody among the nodes of c_walk, whom all of them hear, and particles about him."""
    rng, config = np.random.default_rng(seed), BodyConfig()
    place = np.array([[38.0], [61.0]])
    positions = nodes(config).positions[:, :2]
    d = np.hypot(*(positions.T - place))
    one = mean_rssi(SINGLE, d)
    z = one if curves == 1 else np.where(rng.random(d.size) < 0.5, mean_rssi(LOS, d), mean_rssi(NLOS, d))
    z = z + SIGMA * rng.standard_normal(d.size)
    both = (SINGLE,) if curves == 1 else (LOS, NLOS)
    return Problem(positions, config.area, z, both, place + 3.0 * rng.standard_normal((2, PARTICLES)))


def our_filter(p: Problem) -> tuple[HumanFilter, Readings]:
    """Ours, set to this work."""
    kind = 'single' if len(p.curves) == 1 else 'max'
    config = HumanConfig(
        particles=PARTICLES,
        signal=SignalConfig(kind=kind, extra=0.0, outlier=0.0),
        motion=MotionConfig(kind='random_walk', step=STEP),
        resampling=ResamplingConfig(threshold=1.0),
        start=StartConfig(draws=0, reset_epochs=0),
    )
    anchors = nodes(BodyConfig())
    return HumanFilter(config, anchors, p.area), Readings(p.z, np.full(p.z.size, SIGMA), Curves(LOS, NLOS, SINGLE))


def ours(p: Problem) -> Step:
    """Ours, as the tracker takes it."""
    human, readings = our_filter(p)
    generator = np.random.default_rng(1)
    track = human.begin((), generator)
    track.cloud.s[:2] = p.start

    def step() -> Mean:
        nonlocal track
        done = human.step(track, PERIOD, readings, generator)
        track = done.track
        return float(done.mean[0]), float(done.mean[1])

    return step


def particles(p: Problem) -> Step:
    """A bootstrap filter of the package `particles`."""
    from particles import SMC
    from particles.state_space_models import Bootstrap

    model = particles_model(p)
    data = [p.z[None, :]] * EPOCHS

    def begun() -> Any:
        filtering = SMC(fk=Bootstrap(ssm=model, data=data), N=PARTICLES, resampling='systematic', ESSrmin=1.0)
        return iter(filtering), filtering

    steps, filtering = begun()

    def step() -> Mean:
        nonlocal steps, filtering
        try:
            next(steps)
        except StopIteration:
            steps, filtering = begun()
            next(steps)
        x, y = filtering.W @ filtering.X
        return float(x), float(y)

    return step


def particles_model(p: Problem) -> Any:
    """The state-space model in that package's terms."""
    from particles import distributions as dists
    from particles.state_space_models import StateSpaceModel

    std, (x, y) = STEP * math.sqrt(PERIOD), p.start.mean(axis=-1)

    class Likelier(dists.ProbDist):  # type: ignore[misc]
        """The likelier of two normals."""

        def __init__(self, locs: list[Floats]) -> None:
            self.normals = [dists.Normal(loc=loc, scale=SIGMA) for loc in locs]

        def logpdf(self, z: Floats) -> Floats:
            return np.asarray(np.maximum(*(normal.logpdf(z) for normal in self.normals)))

    class Walk(StateSpaceModel):  # type: ignore[misc]
        """A random walk heard by the nodes."""

        def PX0(self) -> Any:
            return dists.IndepProd(dists.Normal(loc=x, scale=3.0), dists.Normal(loc=y, scale=3.0))

        def PX(self, t: int, xp: Floats) -> Any:
            return dists.IndepProd(*(dists.Normal(loc=xp[:, i], scale=std) for i in (0, 1)))

        def PY(self, t: int, xp: Floats, x: Floats) -> Any:
            each = []
            for node in p.positions:
                d = np.maximum(np.hypot(x[:, 0] - node[0], x[:, 1] - node[1]), LEAST_DISTANCE)
                lg = np.log10(d)
                locs = [curve.p_ref + curve.k * lg for curve in p.curves]
                each.append(dists.Normal(loc=locs[0], scale=SIGMA) if len(locs) == 1 else Likelier(locs))
            return dists.IndepProd(*each)

    return Walk()


def stone_soup(p: Problem) -> Step:
    """Stone Soup's particle predictor and updater; one curve, since its noise is normal."""
    from stonesoup.models.transition.linear import CombinedLinearGaussianTransitionModel, RandomWalk
    from stonesoup.predictor.particle import ParticlePredictor
    from stonesoup.resampler.particle import SystematicResampler
    from stonesoup.types.array import StateVector, StateVectors
    from stonesoup.types.detection import Detection
    from stonesoup.types.hypothesis import SingleHypothesis
    from stonesoup.types.numeric import Probability
    from stonesoup.types.state import ParticleState
    from stonesoup.updater.particle import ParticleUpdater

    model = stone_soup_model(p)
    predictor = ParticlePredictor(CombinedLinearGaussianTransitionModel([RandomWalk(STEP**2), RandomWalk(STEP**2)]))
    updater = ParticleUpdater(model, resampler=SystematicResampler())
    now = datetime(2026, 1, 1)  # noqa: DTZ001 (Stone Soup compares with naive stamps)
    weights = np.full(PARTICLES, Probability(1.0 / PARTICLES))
    state = ParticleState(StateVectors(p.start), weight=weights, timestamp=now)

    def step() -> Mean:
        nonlocal state, now
        now += timedelta(seconds=PERIOD)
        detection = Detection(StateVector(p.z), timestamp=now, measurement_model=model)
        state = updater.update(SingleHypothesis(predictor.predict(state, timestamp=now), detection))
        mean = np.asarray(state.mean, dtype=float).ravel()
        return float(mean[0]), float(mean[1])

    return step


def stone_soup_model(p: Problem) -> Any:
    """The signal strengths in that package's terms."""
    from stonesoup.models.measurement.nonlinear import NonLinearGaussianMeasurement
    from stonesoup.types.array import StateVector, StateVectors

    class SignalStrengths(NonLinearGaussianMeasurement):  # type: ignore[misc]
        """Of all nodes; states are columns."""

        @property
        def ndim_meas(self) -> int:
            return len(self.covar())

        def function(self, state: Any, noise: bool = False, **kwargs: Any) -> Any:
            columns = np.asarray(state.state_vector, dtype=float)
            d = np.hypot(*(columns[:, None, :] - p.positions.T[:, :, None]))
            values = mean_rssi(p.curves[0], d)
            return (StateVector if values.shape[-1] == 1 else StateVectors)(values)

    return SignalStrengths(ndim_state=2, mapping=(0, 1), noise_covar=np.diag(np.full(p.z.size, SIGMA**2)))


def plain_loop(p: Problem) -> Step:
    """Particle by particle and node by node, as the document's steps are usually typed in."""
    rng = random.Random(1)
    std = STEP * math.sqrt(PERIOD)
    cloud = [(float(x), float(y)) for x, y in p.start.T]
    table = [(float(x), float(y), float(z)) for (x, y), z in zip(p.positions, p.z, strict=True)]

    def step() -> Mean:
        nonlocal cloud
        cloud = [(x + rng.gauss(0.0, std), y + rng.gauss(0.0, std)) for x, y in cloud]
        log_w = [log_likelihood(x, y, table, p.curves) for x, y in cloud]
        top = max(log_w)
        w = [math.exp(l - top) for l in log_w]
        total = sum(w)
        w = [v / total for v in w]
        mean = (
            sum(v * x for v, (x, _) in zip(w, cloud, strict=True)),
            sum(v * y for v, (_, y) in zip(w, cloud, strict=True)),
        )
        chosen, sums, j = [], w[0], 0
        tooth = rng.random() / len(w)
        for _ in w:
            while sums < tooth and j < len(w) - 1:
                j += 1
                sums += w[j]
            chosen.append(cloud[j])
            tooth += 1.0 / len(w)
        cloud = chosen
        return mean

    return step


def log_likelihood(x: float, y: float, table: list[tuple[float, float, float]], curves: tuple[Curve, ...]) -> float:
    """Of one place, but for the normals' constants."""
    total = 0.0
    for a_x, a_y, z in table:
        lg = math.log10(max(math.sqrt((a_x - x) ** 2 + (a_y - y) ** 2), LEAST_DISTANCE))
        total += max(-0.5 * ((z - curve.p_ref - curve.k * lg) / SIGMA) ** 2 for curve in curves)
    return total


PEERS: dict[str, Callable[[Problem], Step]] = {
    'particles': particles,
    'Stone Soup': stone_soup,
    'plain loop': plain_loop,
}


def rows(sizes: Sizes) -> Iterable[Row]:
    """One curve and two."""
    for curves, goals in GOALS.items():
        p, missing = problem(curves), {}
        contenders: dict[str, Step] = {'ours': ours(p)}
        for name in goals:
            try:
                contenders[name] = PEERS[name](p)
            except ImportError as error:
                missing[name] = f'not installed ({error.name})'
        took = {name: 1e6 * seconds for name, seconds in cpu_seconds(contenders, sizes).items()}
        work = f'{WORK}, {"one curve" if curves == 1 else "two curves"}'
        for name, goal in goals.items():
            note = missing.get(name, '')
            yield Row(GROUP, work, 'us', took['ours'], name, took.get(name), at_least(goal, ratio=True), note=note)
    p = problem(2)
    _, readings = our_filter(p)
    improved = HumanFilter(HumanConfig(particles=PARTICLES), nodes(BodyConfig()), p.area)
    generator = np.random.default_rng(1)
    track = improved.step(improved.begin((), generator), PERIOD, readings, generator).track
    seconds = cpu_seconds({'improved': lambda: improved.step(track, PERIOD, readings, generator)}, sizes)['improved']
    yield Row(GROUP, f'{WORK}, improved profile', 'us', 1e6 * seconds)

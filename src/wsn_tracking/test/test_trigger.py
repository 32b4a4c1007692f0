import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from oracles import LOOP, properties

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.draws import keyed
from wsn_tracking.sensing import trigger
from wsn_tracking.sensing.stage import SensingStage, TriggerConfig
from wsn_tracking.sensing.values import Epoch, Reason, Rssi
from wsn_tracking.studies.random_q_runs import repeated, sense

NAN = math.nan

# signal strengths near each other and near y_min, so that every verdict occurs; NaN where nothing was heard
signals = arrays(
    np.float64,
    st.tuples(st.integers(1, 12), st.integers(1, 4)),
    elements=st.one_of(st.just(NAN), st.integers(-560, -540).map(lambda v: v / 10.0), st.floats(-57.0, -53.0)),
)
thresholds = st.builds(
    trigger.EventThresholds,
    y_min=st.floats(-56.0, -54.0),
    e_min=st.floats(0.0, 0.4),
    e_max=st.floats(0.5, 2.0),
    alpha=st.floats(0.0, 1.0),
)


def run(step, signals, uniform=None):
    """Verdicts (K, N) and the last yhat."""
    yhat = np.full(signals.shape[1:], NAN)
    verdicts = []
    for k, y in enumerate(signals):
        yhat, verdict = step(yhat, y, np.zeros(y.shape) if uniform is None else uniform[k])
        verdicts.append(verdict)
    return np.array(verdicts), yhat


def event_of_one_node(signals, p):
    """Equations 1 and 2 of the document, one number after the other."""
    yhat, verdicts = None, []
    for y in signals:
        if math.isnan(y):
            verdicts.append(Reason.NOT_HEARD)
            continue
        yhat = y if yhat is None else p.alpha * yhat + (1.0 - p.alpha) * y
        change = abs(y - yhat)
        if y <= p.y_min:
            verdicts.append(Reason.OUT_OF_RADIUS)
        elif change <= p.e_min:
            verdicts.append(Reason.UNCHANGED)
        elif change >= p.e_max:
            verdicts.append(Reason.NOISY)
        else:
            verdicts.append(trigger.SENT)
    return verdicts, NAN if yhat is None else yhat


@properties
@given(signals, thresholds)
def test_event_is_equations_1_and_2(signals, p):
    verdicts, yhat = run(trigger.event(p), signals)
    for node in range(signals.shape[1]):
        expected, last = event_of_one_node(signals[:, node].tolist(), p)
        assert verdicts[:, node].tolist() == [int(v) for v in expected]
        np.testing.assert_array_equal(yhat[node], last)


@properties
@given(signals, thresholds)
def test_the_prefilter_follows_every_signal_that_is_heard_sent_or_not(signals, p):
    """|y - yhat| = alpha |y - yhat of before|: also after signals that were too weak, too wild or unchanged."""
    yhat = np.full(signals.shape[1:], NAN)
    for y in signals:
        before, (yhat, _) = yhat, trigger.event(p)(yhat, y, y)
        heard = ~np.isnan(y)
        np.testing.assert_array_equal(yhat[~heard], before[~heard])
        both = heard & ~np.isnan(before)
        np.testing.assert_allclose(np.abs(y - yhat)[both], p.alpha * np.abs(y - before)[both], atol=1e-12)
        first = heard & np.isnan(before)
        np.testing.assert_array_equal(yhat[first], y[first])


def test_nothing_is_sent_at_the_first_signal():
    verdicts, _ = run(trigger.event(trigger.EventThresholds(e_min=0.0)), np.array([[-40.0, -54.9]]))
    assert verdicts.tolist() == [[Reason.UNCHANGED] * 2]


def test_a_jump_does_not_lock_a_node_out():
    """A prefilter that stood still at a rejected signal would reject every later one as well."""
    steps = np.array([-50.0, -50.0, *(-40.0 - 0.6 * k for k in range(20))])[:, None]
    verdicts, _ = run(trigger.event(trigger.EventThresholds(alpha=0.5)), steps)
    assert verdicts[2, 0] == Reason.NOISY
    assert (verdicts[8:, 0] == trigger.SENT).all()


@properties
@given(signals, st.floats(-56.0, -54.0))
def test_near_sends_what_is_in_radius_and_always_what_is_heard(signals, y_min):
    verdicts, _ = run(trigger.near(y_min), signals)
    np.testing.assert_array_equal(verdicts == trigger.SENT, signals > y_min)
    np.testing.assert_array_equal(verdicts == Reason.NOT_HEARD, np.isnan(signals))
    everything, _ = run(trigger.always(), signals)
    np.testing.assert_array_equal(everything == trigger.SENT, ~np.isnan(signals))


def test_random_sends_its_rate_of_what_is_heard():
    y = np.full((1000, 12), -50.0)
    y[:, 0] = NAN
    verdicts, _ = run(trigger.random(0.43), y, np.random.default_rng(1).random(y.shape))
    assert (verdicts[:, 0] == Reason.NOT_HEARD).all()
    # 11 000 draws: standard deviation 0.0047
    assert np.mean(verdicts[:, 1:] == trigger.SENT) == pytest.approx(0.43, abs=0.015)
    assert set(np.unique(verdicts[:, 1:]).tolist()) == {trigger.SENT, Reason.NOT_DRAWN}


@properties
@given(signals, thresholds)
def test_leading_axes_are_nodes_of_their_own(signals, p):
    flat, _ = run(trigger.event(p), signals)
    stacked, _ = run(trigger.event(p), np.stack([signals, signals[:, ::-1]], axis=1))
    np.testing.assert_array_equal(stacked[:, 0], flat)
    np.testing.assert_array_equal(stacked[:, 1], flat[:, ::-1])


@pytest.mark.parametrize(
    ('config', 'strategy'),
    [
        (TriggerConfig(alpha=0.3), trigger.event(trigger.EventThresholds(alpha=0.3))),
        (TriggerConfig(kind='near', y_min=-46.9), trigger.near(-46.9)),
        (TriggerConfig(kind='always'), trigger.always()),
        (TriggerConfig(kind='random', rate=0.6), trigger.random(0.6)),
    ],
)
def test_the_configuration_makes_the_strategy_that_it_names(config, strategy):
    rng = np.random.default_rng(3)
    y, u = rng.uniform(-60.0, -40.0, (30, 12)), rng.random((30, 12))
    np.testing.assert_array_equal(run(config.strategy(), y, u)[0], run(strategy, y, u)[0])


def test_thresholds_that_let_nothing_through_are_refused():
    with pytest.raises(TrackingError, match=r'`trigger\.e_max` 0\.2 dB is not above `trigger\.e_min` 0\.2 dB'):
        TriggerConfig(e_max=0.2).strategy()


def epochs_of(y):
    """Signal strengths (K, N) of the loop's nodes as epochs."""
    ids = LOOP.anchors.ids.tolist()
    return [
        Epoch(1, k, k * 10**9, tuple(Rssi(0, i, 1, k, k, dbm) for i, dbm in zip(ids, row, strict=True)))
        for k, row in enumerate(y.tolist())
    ]


def test_the_sensing_stage_sends_what_the_batched_study_sends():
    from wsn_tracking.models.radio import rssi_at

    step = trigger.event(trigger.EventThresholds(alpha=LOOP.alpha))
    sensed = sense(LOOP, repeated(LOOP, 2), step, np.random.default_rng(5))
    everything = sense(LOOP, repeated(LOOP, 2), trigger.always(), np.random.default_rng(5))
    stage = SensingStage(TriggerConfig(alpha=LOOP.alpha), LOOP.anchors)
    told = np.full(sensed.z[1].shape, NAN)
    for k, epoch in enumerate(epochs_of(rssi_at(LOOP.anchors, everything.z[1]))):
        for packet in stage.step(epoch).ranges:
            told[k, LOOP.anchors.rows([packet.node_id])[0]] = packet.range
    np.testing.assert_allclose(told, sensed.z[1], rtol=1e-12)
    assert np.isfinite(told).sum() > 100


def test_nodes_and_estimators_draw_from_streams_of_their_own():
    """With one seed for all, node 1 would otherwise send whenever estimator 1 draws a small q."""
    from wsn_tracking.trackers.random_q import LocalEstimator
    from wsn_tracking.trackers.random_q_config import NoiseConfig, RandomQConfig

    estimator = LocalEstimator(RandomQConfig(seed=4, noise=NoiseConfig(q_min=0.0, q_max=1.0)), LOOP.anchors, 1)
    drawn = [estimator.draw(k) for k in range(200)]
    node = [keyed(4, 1, k).random() for k in range(200)]
    assert abs(np.corrcoef(drawn, node)[0, 1]) < 0.3

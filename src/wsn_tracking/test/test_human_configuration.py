"""What a configuration of system C says: profiles, single parameters, contradictions."""

from dataclasses import FrozenInstanceError, fields, is_dataclass, replace

import numpy as np
import pytest
from human_cases import ANCHORS, AREA, FEW, PROFILE

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.models.body import LOS, NLOS, SINGLE
from wsn_tracking.models.walk import PSI, WALKING, X, Y
from wsn_tracking.parameters import build, specs
from wsn_tracking.trackers.human import HumanTracker
from wsn_tracking.trackers.human_config import PROFILES, HumanConfig, MotionConfig, ResamplingConfig, SignalConfig
from wsn_tracking.trackers.human_filter import HumanFilter
from wsn_tracking.trackers.human_models import curves_of


@PROFILE
def test_a_profile_is_what_single_parameters_do_not_say(profile):
    config = HumanConfig(profile=profile)
    chosen = PROFILES[profile]
    assert (config.motion_kind, config.kernel.kind) == (chosen['motion'], chosen['signal'])
    assert (config.v_max, config.extra_db, config.kernel.outlier) == (
        chosen['v_max'],
        chosen['extra'],
        chosen['outlier'],
    )
    assert (config.draws, config.reset_epochs) == (chosen['draws'], chosen['reset'])
    told = build(
        HumanConfig,
        {
            'profile': profile,
            'motion.kind': 'random_walk',
            'motion.v_max': 1.5,
            'signal.kind': 'single',
            'signal.extra': 0.0,
            'signal.outlier': 0.0,
            'start.draws': 0,
            'start.reset_epochs': 0,
        },
    )
    assert (told.motion_kind, told.kernel.kind, told.v_max) == ('random_walk', 'single', 1.5)
    assert (told.extra_db, told.kernel.outlier, told.draws, told.reset_epochs) == (0.0, 0.0, 0, 0)


def test_profiles_are_the_documents():
    baseline = HumanConfig(profile='rss_mcl')
    assert (baseline.kernel.kind, baseline.motion_kind, baseline.extra_db) == ('single', 'disc', 5.6)
    assert HumanConfig(profile='paper_max').v_max == 4.0
    assert HumanConfig().profile == 'improved'
    assert HumanConfig().particles == 500


def test_walkers_of_profiles_without_legs_always_walk():
    for profile in ('paper_max', 'rss_mcl'):
        config = replace(FEW, profile=profile)
        s = HumanFilter(config, ANCHORS, AREA).begin((3,), np.random.default_rng(1)).cloud.s
        assert s[:, WALKING].all()
        assert s[:, [X, Y]].max() > 90.0
        assert s[:, PSI].max() > 6.0


def test_every_parameter_is_described_and_its_default_is_accepted():
    for spec in specs(HumanConfig):
        assert spec.why
    assert build(HumanConfig, {spec.name: spec.default for spec in specs(HumanConfig)}) == HumanConfig()


@pytest.mark.parametrize(
    ('config', 'words'),
    [
        (HumanConfig(area=(0.0, 0.0, -1.0, 1.0)), 'expected x_min'),
        (HumanConfig(area=(0.0, 0.0)), 'expected x_min'),
        (HumanConfig(signal=SignalConfig(los=(1.0,))), 'signal.los'),
        (HumanConfig(signal=SignalConfig(outlier=-0.5)), '`signal.outlier` is -0.5: expected 0 or more, or -1'),
        (HumanConfig(signal=SignalConfig(extra=-0.5)), '`signal.extra` is -0.5'),
        (HumanConfig(motion=MotionConfig(v_max=-0.5)), '`motion.v_max` is -0.5'),
        (HumanConfig(profile='paper_max', motion=MotionConfig(v_max=0.0)), '`motion.v_max` is 0'),
        (HumanConfig(motion=MotionConfig(slowest=3.0)), 'motion.fastest'),
        (HumanConfig(resampling=ResamplingConfig(kld_least=10, kld_most=5)), 'kld_most'),
    ],
)
def test_contradictions_are_refused(config, words):
    with pytest.raises(TrackingError, match=words):
        HumanTracker(config, ANCHORS)


def test_given_curves_are_for_every_node_and_loss_is_of_all():
    anchors = make_anchors([1, 2], [[0.0, 0.0], [5.0, 0.0]], p1_dbm=[-40.0, -60.0], n=2.0)
    given_ = curves_of(HumanConfig(signal=SignalConfig(curves='given', body_loss=-6.5)), anchors)
    for curve, base in zip(given_, (LOS, NLOS, SINGLE), strict=True):
        np.testing.assert_array_equal(curve.p_ref, np.full(2, base.p_ref - 6.5))
        np.testing.assert_array_equal(curve.k, np.full(2, base.k))
    own = curves_of(HumanConfig(signal=SignalConfig(body_loss=-6.5)), anchors)
    np.testing.assert_allclose(own.single.p_ref, [-46.5, -66.5])


def test_the_configuration_and_its_groups_are_frozen():
    config = HumanConfig()
    values = [config, *(getattr(config, field.name) for field in fields(config))]
    groups = [value for value in values if is_dataclass(value)]
    assert {MotionConfig, SignalConfig, ResamplingConfig} < {type(group) for group in groups}
    for group in groups:
        with pytest.raises(FrozenInstanceError):
            setattr(group, fields(group)[0].name, None)

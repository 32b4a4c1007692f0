"""A scene of a robot on a line, seen by a few nodes."""

from evaluation_cases import noisy_track

from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.sensing.values import TriggerReport
from wsn_tracking.viewing.scene import Scene

S = 1_000_000_000


def report(seq, sent=(), silent=(), reasons=(), target=1):
    """What the sensing nodes told of the epoch at second `seq`."""
    return TriggerReport(seq * S, target, seq, sent, tuple(range(len(sent))), silent, reasons)


def filled(epochs=60, length=20):
    """A scene that has seen a white track and its truth."""
    truth, estimates = noisy_track(epochs=epochs)
    scene = Scene(length)
    scene.add_anchors(make_anchors(range(1, 5), [(0, 0), (8, 0), (8, 4), (0, 4)]))
    for stamp, position in zip(truth.stamps_ns.tolist(), truth.positions, strict=True):
        scene.add_truth(1, stamp, position)
    for estimate in estimates:
        scene.add_estimate('fused_1', estimate._replace(target_id=1))
    return scene, truth, estimates

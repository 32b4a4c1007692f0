"""marker_node: draws a running graph for RViz and Foxglove, and is waited for by nobody."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from visualization_msgs.msg import MarkerArray

from wsn_tracking.models.anchors import Anchors
from wsn_tracking.node_parameters.listeners import MarkerConfig
from wsn_tracking.nodes import markers, qos
from wsn_tracking.nodes.base import TrackingNode, run
from wsn_tracking.nodes.health import OK, Health
from wsn_tracking.nodes.paths import Paths
from wsn_tracking.nodes.scenery import Scenery
from wsn_tracking.viewing.scene import Scene


class MarkerNode(TrackingNode[MarkerConfig]):
    """Publishes what its scene holds whenever that has changed, but not more often than `redraw_rate`."""

    def __init__(self) -> None:
        super().__init__('marker_node', MarkerConfig)
        self._asked = [name for name in self.config.outputs if name]
        self._scene = Scene(self.config.track_length)
        self._scenery = Scenery(self, self._scene, self.take, self._choose)
        self._colors: dict[str, str] = {}
        self._drawn = 0  # version of the scene
        self._drawn_anchors: Anchors | None = None
        self._arrays = 0
        self._fixed = self.create_publisher(MarkerArray, 'anchor_markers', qos.LATCHED_LAST)
        self._moving = self.create_publisher(MarkerArray, 'markers', qos.DISPLAY)
        self._paths = Paths(self, self.config.target_height)
        self._frames: Any = None
        self.create_timer(1.0 / self.config.redraw_rate, self._draw)

    def _choose(self, there: Iterable[str]) -> Sequence[str]:
        return self._asked or sorted(there)

    def _draw(self) -> None:
        if self._scene.version == self._drawn:
            return
        self._drawn = self._scene.version
        anchors = self._scene.anchors
        size = self.config.marker_size or markers.node_size(anchors)
        if anchors is not None and anchors is not self._drawn_anchors:
            self._drawn_anchors = anchors
            self._fixed.publish(markers.anchor_markers(anchors, size))
            self._publish_frames(anchors)
        array = markers.scene_markers(self._scene, self._colors, size, self.config.target_height)
        if array.markers:
            self._moving.publish(array)
            self._arrays += 1
        self._paths.publish(self._scene)

    def _publish_frames(self, anchors: Anchors) -> None:
        """Tell of the frame map, where transforms are installed: RViz draws in no frame that it does not know."""
        try:
            from tf2_msgs.msg import TFMessage
        except ImportError:
            return
        if self._frames is None:
            self._frames = self.create_publisher(TFMessage, '/tf_static', qos.LATCHED_LAST)
        self._frames.publish(TFMessage(transforms=markers.node_frames(anchors, self.get_clock().now().nanoseconds)))

    def health(self) -> Health:
        """Nothing to draw yet is no error."""
        return Health(OK, 'drawing' if self._arrays else 'no data yet')

    def state(self) -> Mapping[str, Any]:
        """What is drawn."""
        newest = self._scene.newest
        return {
            'epoch': -1 if newest is None else newest.request_seq,
            'outputs': list(self._scenery.outputs),
            'arrays': self._arrays,
        }


def main() -> None:
    """Run the node."""
    run(MarkerNode)

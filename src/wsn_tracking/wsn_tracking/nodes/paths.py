"""Tracks and truths of a scene as nav_msgs/Path, a topic each, for viewers and tools that know no markers."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Path
from rclpy.node import Node
from rclpy.publisher import Publisher

from wsn_tracking.nodes import qos
from wsn_tracking.nodes.convert import header
from wsn_tracking.trackers.estimate import Estimate, Kind
from wsn_tracking.viewing.scene import Scene

Place = tuple[int, float, float]  # stamp [ns], x, y [m]


class Paths:
    """`path/<output>` and `path/truth_target_<id>`, made when there is something on them."""

    def __init__(self, node: Node, height: float) -> None:
        """height [m]: at which they lie."""
        self._node, self._height = node, height
        self._publishers: dict[str, Publisher] = {}
        self._last: dict[str, Place] = {}  # by topic, so that nothing is said twice

    def publish(self, scene: Scene) -> None:
        """Whatever has grown."""
        for topic, places in places_of(scene):
            if topic not in self._publishers:
                self._publishers[topic] = self._node.create_publisher(Path, topic, qos.LATCHED_LAST)
            if self._last.get(topic) != places[-1]:
                self._last[topic] = places[-1]
                self._publishers[topic].publish(path_message(places, self._height))


def places_of(scene: Scene) -> Iterator[tuple[str, Sequence[Place]]]:
    """Topics with what is to be said on them; an output of which nothing is known yet has none."""
    for track in scene.tracks:
        if places := _found(track.estimates):
            yield f'path/{track.name}', places
    for trail in scene.trails:
        rows = zip(trail.stamps_ns.tolist(), *trail.positions.T.tolist(), strict=True)
        yield f'path/truth_target_{trail.target_id}', list(rows)


def path_message(places: Iterable[Place], height: float) -> Path:
    """The places, in frame map, each with its stamp; the path has that of the last."""
    poses = []
    for stamp, x, y in places:
        pose = PoseStamped(header=header(stamp))
        pose.pose.position.x, pose.pose.position.y, pose.pose.position.z = x, y, height
        poses.append(pose)
    return Path(header=poses[-1].header, poses=poses)


def _found(estimates: Sequence[Estimate]) -> list[Place]:
    """Without what is said while the target is still looked for."""
    return [(e.stamp_ns, float(e.mean[0]), float(e.mean[1])) for e in estimates if e.kind != Kind.START]

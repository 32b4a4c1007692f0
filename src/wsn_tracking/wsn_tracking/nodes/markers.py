"""A scene as markers for RViz and Foxglove; ids are targets, namespaces say what is drawn (docs/visualisation.md)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from geometry_msgs.msg import Point, TransformStamped, Vector3
from std_msgs.msg import ColorRGBA, Header
from visualization_msgs.msg import Marker, MarkerArray

from wsn_tracking.evaluation.ellipses import ellipse, known
from wsn_tracking.evaluation.plot_style import COLOURS, INK, MUTED
from wsn_tracking.models.anchors import Anchors, Floats
from wsn_tracking.nodes.convert import header
from wsn_tracking.viewing.node_states import look, rgb
from wsn_tracking.viewing.scene import Scene, Track

SHARE = 0.018  # size of a node in the extent of all of them
SMALLEST = 0.02  # [m]
ELLIPSE_POINTS = 41
WHOLE = '#c8c8c8'  # the largest component


def node_size(anchors: Anchors | None) -> float:
    """Diameter of a node [m] that suits where the nodes are."""
    if anchors is None:
        return 0.1
    extent = float(np.max(np.ptp(anchors.positions[:, :2], axis=0)))
    return max(SHARE * extent, SMALLEST)


def anchor_markers(anchors: Anchors, size: float) -> MarkerArray:
    """Where the nodes are, with their ids; whatever was there before is taken away."""
    head = header(0)
    boxes = _marker(head, 'anchors', 0, Marker.CUBE_LIST, MUTED, (0.6 * size,) * 3)
    boxes.points = _points(anchors.positions, 0.0)
    texts = []
    for node, place in zip(anchors.ids.tolist(), anchors.positions, strict=True):
        text = _marker(head, 'anchors/id', node, Marker.TEXT_VIEW_FACING, INK, (0.0, 0.0, 1.3 * size))
        text.text = str(node)
        text.pose.position = _points([place + np.array([0.0, 1.3 * size, 0.0])], 0.0)[0]
        texts.append(text)
    return MarkerArray(markers=[Marker(header=head, action=Marker.DELETEALL), boxes, *texts])


def scene_markers(scene: Scene, colors: dict[str, str], size: float, height: float) -> MarkerArray:
    """The latest epochs: nodes by what they did, every output's track, ellipse and place, the truth.

    Each marker has the stamp of the newest thing in it. colors: of each output, extended here in the order of
    appearance; height [m] at which estimates are drawn.
    """
    markers = [*_components(scene, size), *_links(scene, size), *_nodes(scene, size)]
    for track in scene.tracks:
        color = colors.setdefault(track.name, COLOURS[len(colors) % len(COLOURS)])
        markers += _track(track, color, size, height)
    for trail in scene.trails:
        head = header(int(trail.stamps_ns[-1]))
        line = _marker(head, 'truth', trail.target_id, Marker.LINE_STRIP, INK, (0.35 * size, 0.0, 0.0))
        line.points = _points(trail.positions, height)
        place = _marker(head, 'truth/position', trail.target_id, Marker.SPHERE, INK, (1.2 * size,) * 3)
        place.pose.position = line.points[-1]
        markers += [_shown(line), place]
    return MarkerArray(markers=markers)


def node_frames(anchors: Anchors, ns: int) -> list[TransformStamped]:
    """Frames node_<id> in frame map, so that a viewer knows the frame map."""
    frames = []
    for node, place in zip(anchors.ids.tolist(), anchors.positions.tolist(), strict=True):
        frame = TransformStamped(header=header(ns), child_frame_id=f'node_{node}')
        frame.transform.translation = Vector3(x=place[0], y=place[1], z=place[2])
        frames.append(frame)
    return frames


def _nodes(scene: Scene, size: float) -> list[Marker]:
    states = scene.node_states
    if scene.anchors is None or not states:
        return []
    flat = (1.6 * size, 1.6 * size, 0.2 * size)
    marker = _marker(header(scene.reported_ns), 'nodes', 0, Marker.SPHERE_LIST, MUTED, flat)
    marker.points = _points(scene.anchors.positions, 0.0)
    marker.colors = [_color(look(states.get(node)).color) for node in scene.anchors.ids.tolist()]
    return [marker]


def _links(scene: Scene, size: float) -> list[Marker]:
    """A line for every link over which something was used, in the colour of its component."""
    markers = []
    for links in scene.links if scene.anchors is not None else ():
        colors = {node: _component_color(rank) for rank, group in enumerate(links.components) for node in group}
        line = _marker(
            header(scene.reported_ns), 'links', links.target_id, Marker.LINE_LIST, MUTED, (0.1 * size, 0.0, 0.0)
        )
        for pair in links.pairs:
            ends = _places(scene, pair)
            if len(ends) == len(pair):
                line.points += ends
                line.colors += [_color(colors.get(pair[1], colors.get(pair[0], MUTED)))] * 2
        markers.append(_shown(line))
    return markers


def _components(scene: Scene, size: float) -> list[Marker]:
    """A wide disc under every living node, in the colour of the component that it is in."""
    markers = []
    for links in scene.links if scene.anchors is not None else ():
        flat = (2.6 * size, 2.6 * size, 0.1 * size)
        disc = _marker(header(scene.reported_ns), 'components', links.target_id, Marker.SPHERE_LIST, MUTED, flat)
        for rank, group in enumerate(links.components):
            places = _places(scene, group)
            disc.points += places
            disc.colors += [_color(_component_color(rank))] * len(places)
        markers.append(disc)
    return markers


def _component_color(rank: int) -> str:
    """The largest component is grey; a network that has fallen apart shows in colours."""
    return COLOURS[(rank - 1) % len(COLOURS)] if rank else WHOLE


def _places(scene: Scene, nodes: Sequence[int]) -> list[Point]:
    """Where nodes are, those that the table knows."""
    assert scene.anchors is not None  # whoever draws has looked
    rows = scene.anchors.rows(nodes)
    return _points(scene.anchors.positions[rows[rows >= 0]], 0.0)


def _track(track: Track, color: str, size: float, height: float) -> list[Marker]:
    name, target = track.name, track.target_id
    head = header(track.estimates[-1].stamp_ns)
    line = _marker(head, name, target, Marker.LINE_STRIP, color, (0.3 * size, 0.0, 0.0))
    line.points = _points([e.mean[:2] for e in track.estimates], height)
    place = _marker(head, f'{name}/position', target, Marker.SPHERE, color, (1.2 * size,) * 3)
    place.pose.position = line.points[-1]
    ring = _marker(head, f'{name}/ellipse', target, Marker.LINE_STRIP, color, (0.2 * size, 0.0, 0.0))
    means, covariances = known(track.estimates[-1:])
    if len(means):
        ring.points = _points(ellipse(means, covariances, ELLIPSE_POINTS)[0], height)
    return [_shown(line), place, _shown(ring)]


def _shown(line: Marker) -> Marker:
    """A line strip; one of fewer than two points is none, and takes away what was there."""
    if len(line.points) < 2:
        line.action, line.points = Marker.DELETE, []
    return line


def _marker(head: Header, ns: str, number: int, kind: int, color: str, scale: tuple[float, float, float]) -> Marker:
    marker = Marker(header=head, ns=ns, id=number, type=kind, color=_color(color), frame_locked=True)
    marker.pose.orientation.w = 1.0
    marker.scale = Vector3(x=scale[0], y=scale[1], z=scale[2])
    return marker


def _color(color: str) -> ColorRGBA:
    red, green, blue = rgb(color)
    return ColorRGBA(r=red, g=green, b=blue, a=1.0)


def _points(places: Floats | Sequence[Floats], height: float) -> list[Point]:
    """Points (K, 3), or (K, 2) at a height."""
    rows = np.asarray(places, dtype=np.float64)
    rows = rows if rows.shape[1] == 3 else np.column_stack([rows, np.full(len(rows), height)])
    return [Point(x=x, y=y, z=z) for x, y, z in rows.tolist()]

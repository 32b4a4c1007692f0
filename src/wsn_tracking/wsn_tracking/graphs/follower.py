"""Two robots in phase (seed 001, its second experiment): a simulated sink, the bridge, and system D, in a ring.

The sink's nodes range both robots; the hybrid tracker tells where they are; the bridge sends that back down the line;
the second robot drives by it.
"""

from __future__ import annotations

from pathlib import Path

from wsn_tracking.configuration import load_configuration
from wsn_tracking.graphs.parts import How, Process, Source, complete
from wsn_tracking.graphs.random_q import BRIDGE
from wsn_tracking.graphs.single import plan_single
from wsn_tracking.node_parameters.serial import SinkSimulatorConfig
from wsn_tracking.parameters import Values, build
from wsn_tracking.simulation.d_cells import AREA, nodes
from wsn_tracking.simulation.driven import FIRST, SECOND

SINK = 'sink_simulator'
FEEDBACK_S = 0.1  # [s] between two positions of a robot that are fed back
LINGER_S = 1.0  # [s] after the last range, for the last estimates


def follower(
    link: str,
    *,
    seed: int = 1,
    configuration: str = 'hybrid',
    settings: Values | None = None,
    record: str = '',
    markers: bool = False,
) -> tuple[Process, ...]:
    """The ring over the pseudo terminal `link`; it ends with the sink."""
    world: dict[str, object] = {'driven.on': True, 'seed': seed, 'linger': LINGER_S, **(settings or {})}
    cells = build(SinkSimulatorConfig, world).driven.cells
    anchors = nodes()
    source = Source(
        title='follower',
        entry_level='range',
        ids=tuple(anchors.ids.tolist()),
        targets=(FIRST, SECOND),
        metadata={'period': f'{cells.period:g}', 'area': ' '.join(f'{edge:g}' for edge in AREA)},
        topics=('request', 'range', 'epoch_end'),
    )
    plan = plan_single('hybrid', source, load_configuration(configuration), settings)
    fed_back = tuple(f'estimate/{output}' for output in plan.outputs)
    bridge = {
        'port': link,
        'period': cells.period,
        'feedback': True,
        'feedback_topics': list(fed_back),
        'feedback_period': FEEDBACK_S,
        'anchors.ids': anchors.ids.tolist(),
        'anchors.x': anchors.positions[:, 0].tolist(),
        'anchors.y': anchors.positions[:, 1].tolist(),
        **(settings or {}),
    }
    graph = complete(
        source,
        [plan],
        Process('serial_bridge_node', BRIDGE, bridge, takes=fed_back),
        How(live=True, settings=settings or {}),
        record={'output': str(Path(record).resolve()), 'derived': True} if record else None,
        markers=markers,
    )
    waited_for = [process.name for process in graph if process.name != 'markers']
    sink = {'link': link, 'publish_anchors': False, 'expected_nodes': waited_for, **world}
    return (*graph, Process('sink_simulator', SINK, sink))

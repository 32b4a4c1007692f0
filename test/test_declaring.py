"""Parameters of a node as ROS 2 tools see them: typed, described, dumped and loaded again, strangers named."""

import contextlib

import pytest
import rclpy
import yaml
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile
from std_msgs.msg import String

from wsn_tracking import parameters
from wsn_tracking.graphs import Process
from wsn_tracking.node_parameters.executables import EXECUTABLES
from wsn_tracking.nodes import declaring
from wsn_tracking.processes import write_parameters

TYPES = {
    bool: Parameter.Type.BOOL,
    int: Parameter.Type.INTEGER,
    float: Parameter.Type.DOUBLE,
    str: Parameter.Type.STRING,
}
LISTS = {
    int: Parameter.Type.INTEGER_ARRAY,
    float: Parameter.Type.DOUBLE_ARRAY,
    str: Parameter.Type.STRING_ARRAY,
}


@contextlib.contextmanager
def node_of(*arguments):
    """A node started with these arguments, as `ros2 run` would."""
    context = rclpy.Context()
    rclpy.init(args=['--ros-args', *arguments], context=context)
    try:
        node = Node('some', context=context, start_parameter_services=False)
        yield node
        node.destroy_node()
    finally:
        rclpy.shutdown(context=context)


@pytest.mark.parametrize('name', sorted(EXECUTABLES))
def test_every_parameter_is_described_typed_and_read_only(name):
    kind = EXECUTABLES[name]
    with node_of() as node:
        declaring.declare(node, kind)
        for spec in parameters.specs(kind):
            wanted = LISTS[spec.element] if isinstance(spec.default, tuple) else TYPES[type(spec.default)]
            if spec.default != ():  # rclpy has no typed empty list
                assert node.get_parameter(spec.name).type_ == wanted, spec.name
            told = node.describe_parameter(spec.name)
            assert told.read_only
            assert told.description == spec.why
            assert told.additional_constraints == spec.expected


@pytest.mark.parametrize('name', sorted(EXECUTABLES))
def test_what_a_node_dumps_starts_the_same_node(name, tmp_path):
    """Empty lists included, which a parameter file gives as nothing."""
    kind = EXECUTABLES[name]
    with node_of() as node:
        before = declaring.declare(node, kind)
        names = [spec.name for spec in parameters.specs(kind)]
        dumped = {n: node.get_parameter(n).value for n in names}
    plain = {n: v.tolist() if hasattr(v, 'tolist') else v for n, v in dumped.items()}
    file = tmp_path / 'dumped.yaml'
    file.write_text(yaml.safe_dump({'/some': {'ros__parameters': plain}}))
    with node_of('--params-file', str(file)) as node:
        assert declaring.declare(node, kind) == before


@pytest.mark.parametrize('text', ['y', 'No', '1e5', '0x10', '007', 'nan', '.inf', '~', 'null', '', ' a: b #', 'é"\\n'])
def test_a_text_stays_a_text_whatever_it_looks_like(text, tmp_path):
    """Names of bags, folders and configurations are what users call them."""
    file = write_parameters(Process('evaluator_node', 'e', {'title': text, 'outputs': [text]}), tmp_path)
    with node_of('--params-file', str(file)) as node:
        config = declaring.declare(node, EXECUTABLES['evaluator_node'])
    assert (config.title, config.outputs) == (text, (text,))


def test_a_stranger_among_the_parameters_is_named_with_its_likeliest_meaning(capfd):
    given = ['-p', 'updat.kind:=iplf', '-p', 'trigger.alpha:=0.2', '-p', 'use_sim_time:=true']
    with node_of(*given) as node:
        declaring.declare(node, EXECUTABLES['estimator_node'])
        declaring.warn_of_strangers(node)
    warned = [line for line in capfd.readouterr().err.splitlines() if 'WARN' in line]
    assert len(warned) == 1  # trigger.alpha is another node's
    assert 'there is no parameter `updat.kind`; did you mean `update.kind`?' in warned[0]


def test_quality_of_service_may_be_overridden_at_the_start():
    with node_of('-p', 'qos_overrides./talk.publisher.depth:=7') as node:
        options = declaring.qos_overrides(node)
        publisher = node.create_publisher(String, '/talk', QoSProfile(depth=100), qos_overriding_options=options)
        assert publisher.qos_profile.depth == 7
    with node_of() as node:
        assert declaring.qos_overrides(node) is None

"""Parameter files: those that are shipped are right, and a wrong one is refused with what to do."""

from __future__ import annotations

from pathlib import Path

import pytest
from graph_cases import a_loop
from hypothesis import example, given, settings
from hypothesis import strategies as st

from wsn_tracking.configuration import (
    configuration_names,
    find_configuration,
    load_configuration,
    parse_setting,
    share_folders,
)
from wsn_tracking.errors import TrackingError
from wsn_tracking.graphs import BRIDGE, How, Process, complete, plans_of, source_of, system_of
from wsn_tracking.node_parameters.common import NodeConfig
from wsn_tracking.node_parameters.executables import EXECUTABLES
from wsn_tracking.parameters import build, specs

SHIPPED = sorted((Path(__file__).parents[1] / 'config').glob('*.yaml'))
SECTION = '/**:\n  ros__parameters:\n'


@pytest.fixture
def wrote(tmp_path):
    """Writes a configuration file, gives its name."""

    def write(text):
        path = tmp_path / 'some.yaml'
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return str(path)

    return write


def refusal(name):
    with pytest.raises(TrackingError) as error:
        load_configuration(name)
    assert '\n' not in str(error.value)
    return str(error.value)


# ---- what is shipped


def test_configurations_are_found_by_name():
    assert {'random_q', 'danis_central', 'danis_three'} <= set(configuration_names())
    assert {path.stem for path in SHIPPED} <= set(configuration_names())
    assert find_configuration('random_q').name == 'random_q.yaml'


@pytest.mark.parametrize('path', SHIPPED, ids=lambda path: path.stem)
def test_every_process_of_a_shipped_files_own_system_builds_with_it(path):
    """The same name means another thing elsewhere: a file of one system need not fit the nodes of another."""
    configuration = load_configuration(str(path))
    anchors, system = a_loop(3).anchors, system_of(path.stem)
    level = {'range': 'range', 'observation': 'observation'}.get(configuration.of('estimator_1').get('input'), 'rssi')
    source = source_of('some_bag', a_loop(3))._replace(entry_level=level)
    plans = plans_of(source, anchors, system, configuration)
    feeds = [Process(f'{kind}_node', kind, configuration.of(kind)) for kind in ('bag_player', 'world', 'serial_bridge')]
    for feed in feeds if path.stem == BRIDGE else feeds[:2]:
        for process in complete(source, plans, feed, How(), evaluator={}, record={'output': 'y'}, markers=True):
            build(EXECUTABLES[process.executable], process.parameters)


def test_random_q_names_what_the_document_gives():
    """Complete: every parameter of the trigger, the noise, the update, the start and the fusion that the seed sets."""
    values = load_configuration('random_q').of('estimator_1')
    wanted = {
        'peers': [1, 2, 3], 'trigger.kind': 'event', 'trigger.y_min': -55.0, 'trigger.e_min': 0.2, 'trigger.e_max': 0.6,
        'trigger.alpha': 0.3, 'noise.kind': 'identity', 'update.kind': 'ckf', 'update.r': 'predicted',
        'start.kind': 'likelihood', 'start.epochs': 4, 'fusion.rule': 'trace', 'fusion.feedback': False,
    }  # fmt: skip
    assert {name: values.get(name) for name in wanted} == wanted


def test_danis_three_gives_each_estimator_four_receivers():
    configuration = load_configuration('danis_three')
    nodes = {number: set(configuration.of(f'estimator_{number}')['nodes']) for number in (1, 2, 3)}
    assert nodes == {1: {10, 21, 32, 42}, 2: {20, 31, 41, 11}, 3: {30, 40, 12, 22}}
    assert 'nodes' not in load_configuration('danis_central').of('estimator_1')


def test_data_is_looked_for_where_it_is_installed_first(monkeypatch):
    monkeypatch.setenv('AMENT_PREFIX_PATH', '/first::/second')
    folders = [str(folder) for folder in share_folders('config')]
    assert folders[:2] == ['/first/share/wsn_tracking/config', '/second/share/wsn_tracking/config']
    assert Path(folders[2], 'random_q.yaml').is_file()
    monkeypatch.delenv('AMENT_PREFIX_PATH')
    assert len(list(share_folders())) == 1


# ---- sections


def test_a_section_for_one_node_overrides_that_for_all(wrote):
    configuration = load_configuration(
        wrote(
            '/**:\n  ros__parameters: {peers: [1, 2], trigger: {alpha: 0.1}, trigger.e_min: 0.1}\n'
            '/**/estimator_1:\n  ros__parameters: {trigger.alpha: 0.2}\n'
            'estimator_2:\n  ros__parameters: {trigger: {alpha: 0.3}}\n'
        )
    )
    assert configuration.of('other') == {'peers': [1, 2], 'trigger.alpha': 0.1, 'trigger.e_min': 0.1}
    assert configuration.of('estimator_1')['trigger.alpha'] == 0.2
    assert configuration.of('estimator_2')['trigger.alpha'] == 0.3


def test_numbers_are_read_as_ros_reads_them(wrote):
    text = SECTION + '    {loss_timeout: 1e-3, noise.q_max: 2E+1, area: [.5e1, 1e0, 9, 1.]}'
    assert load_configuration(wrote(text)).of('x') == {
        'loss_timeout': 1e-3,
        'noise.q_max': 20.0,
        'area': [5.0, 1.0, 9, 1.0],
    }


def test_what_every_ros_node_has_is_known(wrote):
    name = wrote(SECTION + '    use_sim_time: true\n    qos_overrides./range.subscription.depth: 5\n')
    assert load_configuration(name).of('x')['use_sim_time'] is True


# ---- mistakes


@pytest.mark.parametrize(
    ('typo', 'meant'),
    [
        ('trigger.alfa', 'trigger.alpha'),
        ('trigger: {e_mim', 'trigger.e_min'),
        ('peer', 'peers'),
        ('noise.q_maks', 'noise.q_max'),
    ],
)
def test_a_typo_gets_the_nearest_name(wrote, typo, meant):
    said = refusal(wrote(f'{SECTION}    {typo}: 1{"}" * typo.count("{")}\n'))
    assert f'there is no parameter `{typo.replace(": {", ".")}`; did you mean `{meant}`?' in said


def test_a_name_like_no_other_is_sent_to_the_list(wrote):
    said = refusal(wrote(SECTION + '    qqqqqqqq: 1'))
    assert 'there is no parameter `qqqqqqqq`; docs/parameters.md lists all' in said


@pytest.mark.parametrize(
    ('text', 'words'),
    [
        ('a: [', 'no readable YAML: while parsing'),
        ('\t', 'no readable YAML'),
        (b'\xff\xfe\xfa', 'cannot be read as text'),
        (b'a: \x00', 'no readable YAML'),
        ('!!python/object:os.system {}', 'no readable YAML'),
        ('x: 2024-13-45', 'no readable YAML: month must be in 1..12'),
        ('x: !!timestamp y', 'no readable YAML'),
        ('x: !!bool y', 'no readable YAML'),
        ('x: ' + '1' * 5000, 'no readable YAML'),
        ('', 'holds no sections: expected `/**:`'),
        ('- 1\n- 2', 'holds no sections: expected `/**:`'),
        ('word', 'holds no sections'),
        ('/**: 5', 'section `/**` has no `ros__parameters:`'),
        ('/**:\n  ros__parameters:', 'section `/**` has no `ros__parameters:`'),
        ('/**:\n  ros__parameters: [1]', 'section `/**` has no `ros__parameters:`'),
        ('peers: [1]', 'section `peers` has no `ros__parameters:`'),
        ('5: {a: 1}', 'section `5` has no `ros__parameters:`'),
    ],
)
def test_a_broken_file_is_refused_in_one_line_that_names_it(wrote, text, words):
    name = wrote(text)
    said = refusal(name)
    assert said.startswith(name)
    assert words in said


@pytest.mark.parametrize('name', ['no_such', '', '/', 'a' * 5000, 'a\0b', '/proc/1/mem/x', '../../random_q'])
def test_a_configuration_that_is_not_there_gets_the_list_of_names(name):
    said = refusal(name)
    assert 'no configuration' in said
    assert 'danis_central' in said
    assert 'random_q' in said


def test_a_file_that_cannot_be_read_is_an_error(wrote, monkeypatch):
    name = wrote(SECTION)

    def refuse(*_, **__):
        raise PermissionError(13, 'Permission denied')

    monkeypatch.setattr(Path, 'read_text', refuse)
    assert 'Permission denied' in refusal(name)


# ---- settings


@pytest.mark.parametrize(
    ('text', 'setting'),
    [
        ('trigger.kind=near', ('trigger.kind', 'near')),
        ('trigger.y_min=-46.9', ('trigger.y_min', -46.9)),
        ('loss_timeout=1e-3', ('loss_timeout', 1e-3)),
        ('peers=[1, 2]', ('peers', [1, 2])),
        ('fusion.feedback=true', ('fusion.feedback', True)),
        ('title=a=b', ('title', 'a=b')),
        ('title=', ('title', None)),
    ],
)
def test_a_setting_is_a_name_and_yaml(text, setting):
    assert parse_setting(text) == setting


@pytest.mark.parametrize(
    ('text', 'words'),
    [
        ('trigger.kind', 'expected name=value'),
        ('', 'expected name=value'),
        ('trigger.kynd=near', 'did you mean `trigger.kind`?'),
        ('=3', 'there is no parameter ``'),
        ('peers=[1', 'no readable YAML'),
        ('peers=2024-13-45', 'month must be in 1..12'),
        ('peers=' + '[' * 1000, 'no readable YAML'),
    ],
)
def test_a_wrong_setting_is_refused(text, words):
    with pytest.raises(TrackingError) as error:
        parse_setting(text)
    assert words in str(error.value)


NAMES = sorted({spec.name for kind in (*EXECUTABLES.values(), NodeConfig) for spec in specs(kind)})


@given(st.sampled_from(NAMES), st.text(max_size=20) | st.text('0123456789abexo_-+.:T![]{}&*,<= \n', max_size=15))
@example('peers', '0b_')
@example('peers', '<<: 1')
@example('peers', '!!int a')
@example('peers', '0x' + 'f' * 5000)
@settings(max_examples=200)
def test_any_text_is_a_value_or_our_error(name, text):
    said = ''
    try:
        assert parse_setting(f'{name}={text}')[0] == name
    except TrackingError as error:
        said = str(error)
    assert said.startswith('setting ') or not said

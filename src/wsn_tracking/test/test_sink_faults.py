"""All faults: seeded, listed on their page, without effect when switched off, and together."""

from pathlib import Path

import pytest
from fault_cases import WORLD, ran
from sink_cases import Host
from zstack_cases import line_bytes

from wsn_tracking.errors import TrackingError
from wsn_tracking.zstack import commands as c
from wsn_tracking.zstack.faults import FAULTS, parse_faults


def test_faults_are_seeded():
    faults = tuple(name for name in FAULTS if name not in {'unplug', 'mute', 'reset'})
    one, same, other = (ran(*faults, seed=seed).actions for seed in (5, 5, 6))
    assert one == same
    assert one != other


@pytest.mark.parametrize('name', [name for name, kind in FAULTS.items() if kind.value == 'share'])
def test_a_fault_that_is_switched_off_changes_nothing(name):
    switched, plain = ran(f'{name}=0').actions, ran().actions
    if name in {'stale', 'boot_text'}:
        switched.pop(1)
    assert switched == plain


def test_page_lists_every_fault_with_its_default():
    page = (Path(__file__).parents[3] / 'docs' / 'sink_simulator.md').read_text('utf-8')
    listed = [line.split('|')[1:4] for line in page.splitlines() if line.startswith('| `')]
    assert [tuple(cell.strip(' `') for cell in cells) for cells in listed] == [
        (name, kind.value, f'{kind.default:g}') for name, kind in FAULTS.items()
    ]


@pytest.mark.parametrize('text', ['nonsense', 'lost=2', 'lost=x', 'lost=-0.1', 'reset=1.5', 'reset=nan', 'lost='])
def test_what_is_no_fault_is_refused(text):
    with pytest.raises(TrackingError, match='expected'):
        parse_faults([text], 1.0, 0)


def test_everything_at_once_never_raises_and_ends():
    host = Host(WORLD, faults=tuple(FAULTS), fault_time=0.5)
    for _ in range(10):
        host.say(c.ZdoStartup(100), c.SysPing(), c.AfRegister(0xE8, 0xBF01, in_clusters=(0x10,)))
        host.until(host.now + 0.3)
    host.simulator.begin(host.now)
    for _ in range(60):
        host.say(line_bytes(c.ZdoStartup(100)), c.AfRegister(0xE8, 0xBF01, in_clusters=(0x10,)))
        host.until(host.now + 1.0)
    assert len(host.simulator.sent) == len(WORLD)
    assert host.reports

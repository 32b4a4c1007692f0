"""The recordings of docs/datasets.md as bags, and their calibrations as docs/calibration.md makes them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from wsn_tracking import graphs
from wsn_tracking.bags.importing.run import import_set
from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation.score import SKIP_S
from wsn_tracking.sensing.channel import Channel
from wsn_tracking.sensing.channel_file import save_channel
from wsn_tracking.sensing.channel_fit import fit_path_loss, fit_ranging
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.surveys import open_survey


class Set(NamedTuple):
    """A recording of docs/datasets.md."""

    kind: str
    marker: str  # a file that tells its folder
    source: str = ''  # what is imported, below that folder; empty: all of it
    rate: float | None = None
    slice_s: float = 0.0  # first part that it is calibrated from, and that is not scored; 0: it has a survey


SETS = {
    'danis': Set('danis', '*_all_sensors.mbd'),
    'kolakowski': Set('kolakowski', 'calibration_df.csv'),
    'lias': Set('lias', 'UWB_dynamic_exp_mid.csv', 'UWB_dynamic_exp_mid.csv', rate=10.0, slice_s=15.0),
    'plaza2': Set('plaza', 'Plaza2_.mat', 'Plaza2_.mat', slice_s=100.0),
    'labyrinth': Set('labyrinth', 'Indoor_UWB_Input.txt', slice_s=10.0),
}
MRCLAM = Set('mrclam', 'Landmark_Groundtruth.dat')  # scored in another way, since robots are seen in bursts


class Bags(NamedTuple):
    """A set as bags, read once, and its calibrations."""

    opened: Sequence[tuple[graphs.Source, Recording]]
    skip_s: float
    channel: str
    with_map: str  # empty: ranges have none


def check_folder(data: Path) -> None:
    """Raise where the folder of the recordings is none."""
    if not data.is_dir():
        raise TrackingError(f'{data} is no folder: the one that holds the recordings is expected (docs/datasets.md)')


def find(data: Path, wanted: Set) -> Path:
    """The folder of a set, or the file of it that is imported."""
    check_folder(data)
    for folder in sorted(path for path in data.iterdir() if path.is_dir()):
        for found in sorted(folder.rglob(wanted.marker)):
            return found if wanted.source else folder
    raise TrackingError(
        f'{data} has no folder with {wanted.marker} in it: fetch {wanted.kind} (docs/datasets.md), or name other sets'
    )


def prepare(data: Path, name: str, work: Path) -> Bags:
    """Import a set, and calibrate from its survey or from its first part."""
    wanted = SETS[name]
    source = find(data, wanted)
    paths = import_set(wanted.kind, source, work / name, wanted.rate)
    found = open_survey(paths[0] if wanted.slice_s else source, wanted.slice_s or None)
    channel, with_map = str(work / f'{name}.yaml'), ''
    if found.ranges:
        save_channel(channel, Channel(found.survey.ids, None, fit_ranging(found.survey), None, found.origin))
    else:
        loss, radio_map, told = fit_path_loss(found.survey)
        with_map = str(work / f'{name}_map.yaml')
        origin = {**found.origin, **told}
        save_channel(channel, Channel(found.survey.ids, loss, None, None, origin))
        save_channel(with_map, Channel(found.survey.ids, loss, None, radio_map, origin))
    return Bags([graphs.open_bag(str(path)) for path in paths], wanted.slice_s or SKIP_S, channel, with_map)


class Sets:
    """The sets below a folder, each prepared when it is first asked for."""

    def __init__(self, data: Path, work: Path) -> None:
        self.data, self.work = data, work
        self._ready: dict[str, Bags] = {}

    def bags(self, name: str) -> Bags:
        """A set as bags."""
        if name not in self._ready:
            self._ready[name] = prepare(self.data, name, self.work)
        return self._ready[name]

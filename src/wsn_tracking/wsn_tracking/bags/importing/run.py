"""Import a set by name: its recordings, with a channel of one's own where one is given, into bags."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

from wsn_tracking.bags.importing import KINDS, danis, kolakowski, labyrinth, lias, mrclam, plaza, zignav
from wsn_tracking.bags.save import save
from wsn_tracking.errors import TrackingError
from wsn_tracking.sensing.recording import Recording

ONE: Mapping[str, Callable[[Path], Recording]] = {  # sets that are one bag
    'kolakowski': kolakowski.load,
    'lias': lias.load,
    'plaza': plaza.load,
    'labyrinth': labyrinth.load,
    'mrclam': mrclam.load,
    'zignav': zignav.load,
}


def import_set(
    kind: str, src: Path | str, out: Path | str, rate: float | None = None, channel: Path | str | None = None
) -> list[Path]:
    """Write the bags of a set and give their folders: `out`, or `out`/<track> where the set holds several tracks.

    rate [Hz]: of a set that was recorded faster than anybody tracks; channel: a calibration that replaces
    the radio of its nodes. Raises TrackingError where files are missing or broken, or a bag exists.
    """
    src, out = Path(src), Path(out)
    if not src.exists():
        raise TrackingError(f'{src} does not exist: the folder of the recording is expected (docs/datasets.md)')
    bags = []
    for bag, recording in _recordings(kind, src, out, rate):
        save(bag, recording if channel is None else with_channel(recording, Path(channel)))
        bags.append(bag)
    return bags


def _recordings(kind: str, src: Path, out: Path, rate: float | None) -> Iterable[tuple[Path, Recording]]:
    if kind not in KINDS:
        raise TrackingError(f'there is no set {kind!r}: expected one of {", ".join(KINDS)}')
    if rate is not None:
        if kind != 'lias':
            raise TrackingError(f'{kind} keeps the epochs of its recording: a rate is for lias alone')
        return [(out, lias.load(src, rate))]
    if kind == 'danis':
        return ((out / name, recording) for name, recording in danis.tracks(src))
    return [(out, ONE[kind](src))]


def with_channel(recording: Recording, path: Path) -> Recording:
    """The recording with the radios of a calibration file."""
    from wsn_tracking.sensing.channel_file import calibrated

    anchors, _ = calibrated(str(path), recording.anchors)
    return recording._replace(anchors=anchors, metadata={**recording.metadata, 'channel': path.name})

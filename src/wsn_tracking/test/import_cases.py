"""What the tests of the importers share: folders of small files, broken ones, and the real data."""

from __future__ import annotations

import gzip
import os
import tempfile
from collections import defaultdict
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st

from wsn_tracking.bags.epochs import with_epoch_ends
from wsn_tracking.bags.importing.run import import_set
from wsn_tracking.bags.read import read
from wsn_tracking.errors import TrackingError
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.sensing.values import EpochEnd, Range, Request, Rssi

Files = Mapping[str, str | bytes]

FEW = settings(max_examples=40, suppress_health_check=[HealthCheck.function_scoped_fixture])
ODD = [b'', b'nan', b'-1', b'1e400', b'99999999999999999999', b'\n', b',', b';', b' ', b'\x00', b'\xff', b'#', b'x']
BREAKS = st.lists(
    st.tuples(st.integers(0, 99), st.floats(0.0, 1.0), st.integers(0, 40), st.sampled_from(ODD)), min_size=1, max_size=4
)


def folder(root: Path, files: Files) -> Path:
    """A folder with these files, by relative path."""
    for name, content in files.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content.encode() if isinstance(content, str) else content)
    return root


def imported(kind: str, files: Files, tmp_path: Path, **options) -> Recording:
    """What the bag of a set of files holds; its EpochEnds are complete."""
    source = folder(Path(tempfile.mkdtemp(dir=tmp_path)), files)
    (bag,) = import_set(kind, source, source / 'bag', **options)
    assert bag == source / 'bag'
    back = read(bag)
    assert with_epoch_ends(back) == back
    return back


def epochs_of(recording: Recording, target_id: int = 1) -> list[tuple[Request, list[Rssi | Range], EpochEnd]]:
    """Every epoch of a target: request, measurements, end; checks that they fit together."""
    of_epoch = defaultdict(list)
    for m in recording.messages:
        if m.target_id == target_id:
            of_epoch[m.seq if isinstance(m, Request) else m.request_seq].append(m)
    assert list(of_epoch) == list(range(len(of_epoch)))
    epochs = []
    for request, *heard, end in of_epoch.values():
        assert isinstance(request, Request)
        assert isinstance(end, EpochEnd)
        assert all(isinstance(m, (Rssi, Range)) for m in heard)
        assert {m.stamp_ns for m in heard} <= {request.stamp_ns}
        assert list(zip(end.node_ids, end.seqs, strict=True)) == [(m.node_id, m.seq) for m in heard]
        epochs.append((request, heard, end))
    stamps = [request.stamp_ns for request, _, _ in epochs]
    assert stamps == sorted(set(stamps))
    assert [end.final for _, _, end in epochs] == [False] * (len(epochs) - 1) + [True]
    return epochs


def same_in_any_dress(kind: str, files: Files, tmp_path: Path) -> None:
    """That texts as other systems write and keep them hold the same."""

    def windows(text: str | bytes) -> bytes:
        raw = text.encode() if isinstance(text, str) else text
        return raw if raw[:2] == b'\x1f\x8b' else b'\xef\xbb\xbf' + raw.replace(b'\n', b'\r\n\r\n')

    dresses = [
        {name: windows(text) for name, text in files.items()},
        {name.upper(): text for name, text in files.items()},
        {
            f'{name}.gz': gzip.compress(text.encode()) if isinstance(text, str) else text
            for name, text in ((name.removesuffix('.gz'), text) for name, text in files.items())
        },
    ]
    plain = imported(kind, files, tmp_path)
    for dress in dresses:
        other = imported(kind, dress, tmp_path)
        assert repr(other.messages) == repr(plain.messages)  # NaN is nothing's equal
        for ours, theirs in zip(plain.anchors, other.anchors, strict=True):
            np.testing.assert_array_equal(ours, theirs)
        assert plain.truth.keys() == other.truth.keys()
        for target, truth in plain.truth.items():
            np.testing.assert_array_equal(other.truth[target].stamps_ns, truth.stamps_ns)
            np.testing.assert_array_equal(other.truth[target].positions, truth.positions)
        assert other.metadata['import_dropped'] == plain.metadata['import_dropped']


def refused(kind: str, files: Files, tmp_path: Path, said: str, **options) -> None:
    """That these files are refused with one line that says what is wrong."""
    with pytest.raises(TrackingError, match=said) as error:
        imported(kind, files, tmp_path, **options)
    assert '\n' not in str(error.value)


def survives(kind: str, files: Files, breaks, tmp_path: Path) -> None:
    """That broken files give a bag that can be read, or one line; never anything else."""
    content = {name: text.encode() if isinstance(text, str) else text for name, text in files.items()}
    for which, where, length, odd in breaks:
        name = sorted(content)[which % len(content)]
        at = round(where * len(content[name]))
        content[name] = content[name][:at] + odd + content[name][at + length :]
    try:
        back = imported(kind, content, tmp_path)
    except TrackingError as error:
        assert '\n' not in str(error)  # noqa: PT017 (both ends are right)
    else:
        assert any(isinstance(m, (Rssi, Range)) for m in back.messages)


def real_data(name: str) -> Path:
    """A recording itself: beside the repository, or where WSN_DATA says.

    Skipped where it is absent: recordings are not ours to hand on, and the parser is tested by files made here as well.
    """
    shared = Path(os.environ.get('WSN_DATA', Path(__file__).resolve().parents[4] / 'shared' / 'data'))
    if not (shared / name).is_dir():
        pytest.skip(f'{shared / name} is not there; set WSN_DATA to the folder that holds {name}')
    return shared / name

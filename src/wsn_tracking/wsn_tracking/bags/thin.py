"""A recording from which readings got lost, as a worse network would have lost them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wsn_tracking.bags.derived import MEASUREMENTS
from wsn_tracking.bags.epochs import with_epoch_ends
from wsn_tracking.models.anchors import Mask
from wsn_tracking.models.links import Loss, gamma, hashed_uniform
from wsn_tracking.sensing.recording import Message, Recording, epoch_key
from wsn_tracking.sensing.values import EpochEnd, Reason, Request, TriggerReport

DOMAIN = 4  # keeps these draws apart from others of the same seed (seed 004)


class Gammas(NamedTuple):
    """What of one target arrives."""

    rows: Mapping[int, int]  # of epochs, by request_seq
    columns: Mapping[int, int]  # of nodes, by id
    arrives: Mask  # (K, N)

    def __call__(self, seq: int, node: int) -> bool:
        """Whether what a node sends in an epoch arrives."""
        return bool(self.arrives[self.rows[seq], self.columns[node]])


def thin(recording: Recording, loss: Loss, seed: int) -> Recording:
    """The recording without what got lost on each link (or in each round), epoch by epoch and target by target.

    Requests, truth and epochs stay, an epoch of which nothing is left, too; the lists of EpochEnds and TriggerReports
    name what is left. The draw of a link is keyed by seed, target, epoch and node: it does not depend on what else the
    bag holds, and a higher rate loses the same and more. Several packets of a node within an epoch share it.
    """
    whole = with_epoch_ends(recording)
    asked: dict[int, dict[int, None]] = {}
    for target, seq in map(epoch_key, whole.messages):
        asked.setdefault(target, {})[seq] = None
    heard = {m.node_id for m in whole.messages if isinstance(m, MEASUREMENTS)}
    nodes = np.array(sorted({*recording.anchors.ids.tolist(), *heard}), dtype=np.int64)
    gammas = {target: _gammas(loss, seed, target, tuple(seqs), nodes) for target, seqs in asked.items()}
    left = [kept for m in whole.messages if (kept := _left(m, gammas[m.target_id])) is not None]
    told = {'loss': f'{loss.rate:g}', 'loss_kind': 'round' if loss.whole_round else 'link', 'loss_seed': str(seed)}
    if loss.burst:
        told['loss_burst'] = f'{loss.burst:g}'
    return whole._replace(messages=tuple(left), metadata={**whole.metadata, **told})


def _gammas(loss: Loss, seed: int, target: int, seqs: tuple[int, ...], nodes: NDArray[np.int64]) -> Gammas:
    uniform = hashed_uniform(DOMAIN, seed, target, np.array(seqs)[:, None], 0 * nodes if loss.whole_round else nodes)
    return Gammas(
        {seq: k for k, seq in enumerate(seqs)},
        {node: i for i, node in enumerate(nodes.tolist())},
        gamma(loss, uniform),
    )


def _left(m: Message, arrives: Gammas) -> Message | None:
    """What is left of a message."""
    if isinstance(m, Request):
        return m
    if isinstance(m, EpochEnd):
        kept = [(i, seq) for i, seq in zip(m.node_ids, m.seqs, strict=True) if arrives(m.request_seq, i)]
        return m._replace(node_ids=tuple(i for i, _ in kept), seqs=tuple(seq for _, seq in kept))
    if isinstance(m, TriggerReport):
        return _report(m, arrives)
    return m if arrives(m.request_seq, m.node_id) else None


def _report(m: TriggerReport, arrives: Gammas) -> TriggerReport:
    """A node whose range got lost is one that was not heard."""
    sent = list(zip(m.sent_ids, m.sent_seqs, strict=True))
    kept = [(i, seq) for i, seq in sent if arrives(m.request_seq, i)]
    lost = tuple(dict.fromkeys(i for i, _ in sent if not arrives(m.request_seq, i)))
    return m._replace(
        sent_ids=tuple(i for i, _ in kept),
        sent_seqs=tuple(seq for _, seq in kept),
        silent_ids=(*m.silent_ids, *lost),
        reasons=(*m.reasons, *[int(Reason.NOT_HEARD)] * len(lost)),
    )

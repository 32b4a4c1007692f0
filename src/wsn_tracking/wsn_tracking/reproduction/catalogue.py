"""All claims, and those that somebody asks for."""

from __future__ import annotations

from collections.abc import Sequence

from wsn_tracking.errors import TrackingError
from wsn_tracking.reproduction import cross_claims, document_a, document_b, document_c, document_d, document_e
from wsn_tracking.reproduction.claims import Claim, Experiment

ROOMS = (document_a, document_b, document_c, document_d, document_e, cross_claims)
CLAIMS: tuple[Claim, ...] = tuple(
    sorted((claim for room in ROOMS for claim in room.CLAIMS), key=lambda claim: (claim.document, int(claim.id[1:])))
)


def wanted(names: Sequence[str], claims: Sequence[Claim] = CLAIMS) -> list[Claim]:
    """The claims of these documents (`A`) or with these ids (`A3`), in any case; none: all."""
    asked = {name.upper() for name in names}
    for name in sorted(asked - {claim.id for claim in claims} - {claim.document for claim in claims}):
        near = [claim.id for claim in claims if claim.document == name[:1]]
        expected = f'one of {", ".join(near)}' if near else 'A to E, X, or a claim as A3'
        raise TrackingError(f'there is no claim or document `{name}`: expected {expected}')
    return [claim for claim in claims if not asked or asked & {claim.id, claim.document}]


def experiments_of(claims: Sequence[Claim]) -> list[Experiment]:
    """What must be run for these claims, each once."""
    return list({claim.experiment.name: claim.experiment for claim in claims if claim.experiment}.values())

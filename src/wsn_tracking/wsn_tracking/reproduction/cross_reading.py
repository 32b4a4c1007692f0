"""What the table of all systems amounts to, recording by recording: words that follow from its rows."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

Json = Mapping[str, Any]
NEAR, FAR = 1.1, 2.0  # of the least RMSE
HONEST = 1.0, 4.0  # NEES of two dimensions, of those whose covariances can be relied on
COLUMNS = (
    'recording',
    'most accurate',
    'RMSE [m]',
    'within 10 % of it',
    'more than twice as far off',
    'know their error (NEES 1 to 4)',
    'of the near ones, sends least',
)


def reading(table: Json) -> list[list[Any]]:
    """A row of COLUMNS for each recording of the JSON's table."""
    named = [dict(zip(table['columns'], row, strict=True)) for row in table['rows']]
    recordings = dict.fromkeys(row['recording'] for row in named)
    return [_row(name, [row for row in named if row['recording'] == name]) for name in recordings]


def _row(recording: str, rows: list[dict[str, Any]]) -> list[Any]:
    known = sorted((row for row in rows if row['RMSE [m]'] is not None), key=lambda row: float(row['RMSE [m]']))
    least = float(known[0]['RMSE [m]'])
    near = [row for row in known if row['RMSE [m]'] <= NEAR * least]
    far = [row for row in known if row['RMSE [m]'] > FAR * least]
    honest = [row for row in known if row['NEES (of 2)'] is not None and HONEST[0] <= row['NEES (of 2)'] <= HONEST[1]]
    fewest = min(row['bytes'] for row in near)
    return [
        recording,
        known[0]['system'],
        least,
        _names(near[1:]),
        _names(far),
        _names(honest),
        _names([row for row in near if row['bytes'] == fewest]),
    ]


def _names(rows: list[dict[str, Any]]) -> str:
    return '; '.join(row['system'] for row in rows)

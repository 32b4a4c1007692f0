"""How every figure looks, and how it reaches the disk: matplotlib without pyplot, so no display is needed."""

from __future__ import annotations

import io
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from wsn_tracking.errors import TrackingError
from wsn_tracking.files import write_whole

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

Place = Literal['outside right upper', 'outside lower center']
Layout = Literal['constrained']
DPI = 150
INK, MUTED, FAINT = '#222222', '#6b6b6b', '#e4e4e4'
# Okabe and Ito's colours, told apart by colour-blind readers too. Black is the truth's, yellow too pale.
COLOURS = ('#0072b2', '#d55e00', '#009e73', '#cc79a7', '#e69f00', '#56b4e9')
DASHES = ('-', (0, (5, 2)), (0, (1, 1.5)))
MOST = 12  # outputs in one figure


class Pen(NamedTuple):
    """How one output is drawn, the same in every figure."""

    color: str
    linestyle: str | tuple[float, tuple[float, ...]]


def pens(names: Iterable[str]) -> dict[str, Pen]:
    """A pen for each output: colours in turn, then the next dash; at most MOST outputs."""
    return {
        name: Pen(COLOURS[i % len(COLOURS)], DASHES[i // len(COLOURS) % len(DASHES)])
        for i, name in enumerate(dict.fromkeys(names))
        if i < MOST
    }


def new_figure(width: float, height: float, dpi: int = DPI, layout: Layout | None = 'constrained') -> Figure:
    """An empty figure [inches]; TrackingError where matplotlib is not installed."""
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ImportError as error:
        raise TrackingError(f'plots need matplotlib, which cannot be imported ({error}): install matplotlib') from error
    figure = Figure(figsize=(width, height), dpi=dpi, layout=layout, facecolor='white')
    FigureCanvasAgg(figure)
    return figure


def dress(axes: Axes) -> None:
    """Thin grid behind the data, no box, quiet ticks."""
    axes.set_axisbelow(True)
    axes.grid(True, color=FAINT, linewidth=0.6)
    for side in ('top', 'right'):
        axes.spines[side].set_visible(False)
    for side in ('left', 'bottom'):
        axes.spines[side].set_color(MUTED)
    axes.tick_params(colors=MUTED, labelsize=8)
    axes.xaxis.label.set(color=INK, fontsize=9)
    axes.yaxis.label.set(color=INK, fontsize=9)


def heading(figure: Figure, title: str, shown: int, there: int, remark: str = '') -> None:
    """The figure's title, which also says when not every output is shown."""
    rest = f' (first {shown} of {there} outputs)' if shown < there else ''
    figure.suptitle(title + rest + remark, x=0.01, ha='left', fontsize=11, color=INK)


def line_handle(label: str, **looks: Any) -> Line2D:
    """A legend entry for a line."""
    from matplotlib.lines import Line2D

    return Line2D([], [], label=label, **looks)


def patch_handle(label: str, **looks: Any) -> Patch:
    """A legend entry for an area."""
    from matplotlib.patches import Patch

    return Patch(label=label, linewidth=0.0, **looks)


def legend_outside(figure: Figure, handles: Sequence[Artist], place: Place = 'outside right upper') -> None:
    """One legend for the figure, beside the data."""
    columns = 1 if 'right' in place else max(1, min(len(handles), 4))
    figure.legend(handles=list(handles), loc=place, ncols=columns, frameon=False, fontsize=8, labelcolor=INK)


def save(figure: Figure, path: str | Path) -> None:
    """Write a PNG whole or not at all; equal figures give equal bytes."""
    content = io.BytesIO()
    figure.savefig(content, format='png', metadata={'Software': None})
    write_whole(path, content.getvalue())

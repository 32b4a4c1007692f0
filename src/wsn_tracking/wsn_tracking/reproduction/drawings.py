"""Plots of the JSON as SVG; matplotlib is imported when the first one is drawn."""

from __future__ import annotations

import io
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from wsn_tracking.evaluation import plot_style as style
from wsn_tracking.models.anchors import Floats

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Json = Mapping[str, Any]


def svg(plot: Json) -> bytes:
    """A plot of the JSON; equal plots give equal bytes."""
    figure = style.new_figure(5.2, 4.4 if plot['equal'] else 3.4)
    axes = figure.add_subplot()
    style.dress(axes)
    draw = _bars if any(isinstance(x, str) for s in plot['series'] for x in s['x']) else _lines
    draw(axes, plot)
    axes.set(xlabel=plot['x'], ylabel=plot['y'])
    axes.set_title(plot['title'], loc='left', fontsize=10, color=style.INK)
    if plot['equal']:
        axes.set_aspect('equal', adjustable='datalim')
    axes.tick_params(which='minor', colors=style.MUTED, labelsize=7)
    if len(plot['series']) > 1:
        style.legend_outside(figure, axes.get_legend_handles_labels()[0], 'outside lower center')
    return as_svg(figure)


def as_svg(figure: Figure) -> bytes:
    """A figure as a file; equal figures give equal bytes, and no fonts are needed from anywhere."""
    import matplotlib as mpl

    out = io.BytesIO()
    with mpl.rc_context({'svg.hashsalt': 'wsn_tracking', 'svg.fonttype': 'none', 'font.family': 'sans-serif'}):
        figure.savefig(out, format='svg', metadata={'Date': None, 'Creator': None})
    return out.getvalue()


def _numbers(values: Any) -> Floats:
    return np.array([np.nan if v is None else v for v in values], dtype=np.float64)


def _lines(axes: Axes, plot: Json) -> None:
    if plot['log_x']:
        axes.set_xscale('log')
    if plot['log_y']:
        axes.set_yscale('log')
    pens = style.pens(s['name'] for s in plot['series'] if s['style'] != 'truth')
    for series in plot['series']:
        x, y = _numbers(series['x']), _numbers(series['y'])
        name = series['name']
        if series['style'] == 'truth':
            axes.plot(x, y, color=style.INK, linewidth=1.8, label=name)
        elif series['style'] == 'points':
            axes.plot(x, y, 'o', color=pens[name].color, markersize=3.5, label=name)
        else:
            marker = 'o' if len(x) < 15 and not plot['equal'] else ''
            axes.plot(x, y, label=name, linewidth=1.2, marker=marker, markersize=3, **pens[name]._asdict())
        if series['low']:
            axes.fill_between(
                x, _numbers(series['low']), _numbers(series['high']), color=pens[name].color, alpha=0.18, linewidth=0
            )


def _bars(axes: Axes, plot: Json) -> None:
    labels = list(dict.fromkeys(x for s in plot['series'] for x in s['x']))
    pens = style.pens(s['name'] for s in plot['series'])
    width = 0.8 / len(plot['series'])
    if plot['log_y']:
        axes.set_yscale('log')
    for i, series in enumerate(plot['series']):
        places = np.array([labels.index(x) for x in series['x']]) + (i + 0.5) * width - 0.4
        y = _numbers(series['y'])
        spread = None
        if series['low']:
            spread = np.abs(np.stack([y - _numbers(series['low']), _numbers(series['high']) - y]))
        colour = pens[series['name']].color
        axes.bar(places, y, width, color=colour, yerr=spread, label=series['name'], ecolor=style.INK, capsize=1.5)
    axes.axhline(0.0, color=style.MUTED, linewidth=0.6)
    axes.set_xticks(range(len(labels)), labels, rotation=0 if sum(map(len, labels)) < 60 and len(labels) < 8 else 30)

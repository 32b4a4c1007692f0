"""Claims with few runs, and JSON of claims that never ran."""

from wsn_tracking.reproduction.catalogue import CLAIMS, wanted
from wsn_tracking.reproduction.content import Setting
from wsn_tracking.reproduction.engine import Workers
from wsn_tracking.reproduction.reproduce import computed

HERE = Workers(jobs=1)
SETTING = Setting(seed=31, quick=True, command='./wsn-tracking reproduce', commit='none')


def small(names, runs):
    """These claims, with one unit of so many runs for each experiment."""
    return [
        claim._replace(experiment=claim.experiment._replace(runs=runs, units=1, quick=1))
        for claim in wanted(names, CLAIMS)
    ]


def measured(names, runs):
    """The JSON of these claims, with few runs."""
    return computed(small(names, runs), SETTING, HERE)


def figure(interval, shape=None, near=None):
    """A figure of the JSON."""
    low, high = interval
    middle = None if low is None else 0.5 * (low + high)
    told = {'name': 'ratio', 'value': middle, 'unit': '', 'document': 1.0}
    return {**told, 'interval_95': [low, high], 'shape': shape, 'near': near}


def claim(*figures, kind='document', in_kind=False, impossible=''):
    """A claim of the JSON."""
    return {'id': 'X1', 'kind': kind, 'in_kind': in_kind, 'impossible': impossible, 'figures': list(figures)}

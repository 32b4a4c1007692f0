"""The last full reproduction, and the pages that quote it."""

from live import ROOT
from quotes import page, results

PAGE = page('reproduction')
README = (ROOT / 'README.md').read_text('utf-8')
KEPT = results('reproduction')
FIGURES = {c['id']: {f['name']: f['value'] for f in c['figures']} for c in KEPT['claims']}


def ends(values):
    """The least and the greatest."""
    return [min(values), max(values)]

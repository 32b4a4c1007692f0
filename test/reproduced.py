"""The last full reproduction, and the pages that quote it."""

import json

from live import ROOT

PAGE = (ROOT / 'docs' / 'reproduction.md').read_text('utf-8')
README = (ROOT / 'README.md').read_text('utf-8')
KEPT = json.loads((ROOT / 'docs' / 'results' / 'reproduction.json').read_text('utf-8'))
FIGURES = {c['id']: {f['name']: f['value'] for f in c['figures']} for c in KEPT['claims']}


def ends(values):
    """The least and the greatest."""
    return [min(values), max(values)]

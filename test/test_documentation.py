"""The reference pages say what the code says."""

from __future__ import annotations

import pytest

import live
from wsn_tracking.documentation import PAGES


@pytest.mark.parametrize('name', PAGES)
def test_page_is_what_the_code_says(name):
    assert (live.ROOT / 'docs' / name).read_text('utf-8') == PAGES[name](), (
        'run ./env python -m wsn_tracking.documentation docs'
    )

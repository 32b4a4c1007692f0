"""Numbers that a page quotes."""

import re

import pytest

NUMBER = r'(-?\d+(?:\.\d+)?)'


def told(words, text):
    """The numbers that stand where `words` have a @; once in the text, wherever its lines end."""
    pattern = NUMBER.join(map(re.escape, ' '.join(words.split()).split('@')))
    (found,) = re.findall(pattern, ' '.join(text.split()))
    return [found] if isinstance(found, str) else list(found)


def quoted(*pairs):
    """That numbers are quoted to within one unit of their last digit, as they are printed."""
    for text, value in pairs:
        assert float(text) == pytest.approx(value, abs=0.51 * 10.0 ** -len(text.partition('.')[2])), (text, value)

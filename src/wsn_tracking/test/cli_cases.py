"""The command line as tests call it: what it prints and starts, its exit code, and bags to give it."""

from __future__ import annotations

import pytest
from graph_cases import a_loop, ranged, with_second_target, without_truth

from wsn_tracking.bags.save import save
from wsn_tracking.cli import main
from wsn_tracking.sensing.stage import TriggerConfig

EPOCHS = 9


def save_bags(folder):
    """One bag of each kind; the first two are scored."""
    save(folder / 'first', a_loop(EPOCHS))
    save(folder / 'second', a_loop(EPOCHS, 3))
    save(folder / 'ranged', ranged(a_loop(EPOCHS), TriggerConfig(kind='near')))
    save(folder / 'no_truth', without_truth(a_loop(2)))
    save(folder / 'two_targets', with_second_target(a_loop(2)))
    return folder


class Called:
    """What a call printed, and its exit code."""

    def __init__(self, capsys, *arguments):
        with pytest.raises(SystemExit) as ended:
            main([str(argument) for argument in arguments])
        self.code = ended.value.code
        self.out, self.err = capsys.readouterr()


class Started:
    """In the place of what starts processes: notes them; `code` is what they end with."""

    code = 0

    def __call__(self, graph, last):
        self.graph, self.last = {p.name: p for p in graph}, list(last)
        return self.code

"""The command line: `wsn-tracking COMMAND`; each command is a module of `commands`."""

from __future__ import annotations

import argparse
import io
import sys
from collections.abc import Sequence
from importlib import import_module

from wsn_tracking.errors import TrackingError
from wsn_tracking.streams import give_up_output, replace_closed_output

COMMANDS = (  # modules of `commands`, in the order of --help
    'replay',
    'evaluate',
    'plot',
    'watch',
    'info',
    'simulate',
    'import_data',
    'calibrate',
    'degrade',
    'sink',
    'reproduce',
    'bench',
)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run one command; an error is one line and exit code 1, a wrong call exit code 2, Ctrl-C at any moment 130."""
    try:
        code = _run(arguments)
    except KeyboardInterrupt:
        code = 130
    sys.exit(code)


def _run(arguments: Sequence[str] | None) -> int:
    replace_closed_output()
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors='backslashreplace')  # a name that the terminal cannot show is no reason to fail
    options = _parser().parse_args(arguments)
    try:
        code: int = options.do(options)
        sys.stdout.flush()
    except BrokenPipeError:
        give_up_output()
        return 141
    except (TrackingError, OSError) as error:
        print(f'wsn-tracking {options.command}: error: {" ".join(str(error).split())}', file=sys.stderr)
        return 1
    return code


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog='wsn-tracking',
        description='Track moving targets from the signal strengths and ranges of a wireless sensor network.',
    )
    commands = parser.add_subparsers(dest='command', required=True, metavar='COMMAND')
    for name in COMMANDS:
        import_module(f'wsn_tracking.commands.{name}').add(commands)
    return parser


if __name__ == '__main__':
    main()

"""The command line: `wsn-tracking COMMAND`; each command is a module of `commands`."""

from __future__ import annotations

import argparse
import io
import os
import sys
from collections.abc import Sequence

from wsn_tracking.commands import (
    bench,
    calibrate,
    degrade,
    evaluate,
    import_data,
    info,
    plot,
    replay,
    reproduce,
    simulate,
    sink,
    watch,
)
from wsn_tracking.errors import TrackingError

COMMANDS = (
    replay,
    evaluate,
    plot,
    watch,
    info,
    simulate,
    import_data,
    calibrate,
    degrade,
    sink,
    reproduce,
    bench,
)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run one command; an error is one line and exit code 1, a wrong call exit code 2."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors='backslashreplace')  # a name that the terminal cannot show is no reason to fail
    options = _parser().parse_args(arguments)
    try:
        code = options.do(options)
        sys.stdout.flush()
    except BrokenPipeError:  # the reader of our output has gone, as `| head` does
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # what is still to be written has no reader
        code = 141
    except (TrackingError, OSError) as error:
        print(f'wsn-tracking {options.command}: error: {" ".join(str(error).split())}', file=sys.stderr)
        code = 1
    except KeyboardInterrupt:
        code = 130
    sys.exit(code)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog='wsn-tracking',
        description='Track moving targets from the signal strengths and ranges of a wireless sensor network.',
    )
    commands = parser.add_subparsers(dest='command', required=True, metavar='COMMAND')
    for module in COMMANDS:
        module.add(commands)
    return parser


if __name__ == '__main__':
    main()

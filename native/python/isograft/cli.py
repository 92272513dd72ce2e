# SPDX-License-Identifier: GPL-3.0-or-later
"""The command `isograft`: subcommands, exit codes, and how errors are told."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Sequence

import isograft
from isograft.cli_evaluate import add_evaluate
from isograft.cli_match import add_match
from isograft.cli_outcome import CANCELLED, FAILED, USAGE, BadInput
from isograft.cli_transfer import add_transfer

_EPILOG = """exit codes: 0 ok, 1 failed, 2 wrong usage or bad input, 3 nothing matched (the map is still written),
130 cancelled"""


def build_parser() -> argparse.ArgumentParser:
    """Every subcommand sets `run`: a function of the parsed arguments that returns the exit code."""
    parser = argparse.ArgumentParser(prog="isograft", description=isograft.__doc__.splitlines()[0], epilog=_EPILOG)
    parser.add_argument("--version", action="version", version=f"isograft {isograft.__version__}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    add_match(commands, _EPILOG)
    add_evaluate(commands, _EPILOG)
    add_transfer(commands, _EPILOG)
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Run one subcommand; returns its exit code. What is nobody's input's fault leaves as a traceback, code 1."""
    try:
        arguments = build_parser().parse_args(argv)
    except SystemExit as stop:  # argparse has printed why: 0 after --help, 2 for wrong usage
        return stop.code if isinstance(stop.code, int) else USAGE
    run: Callable[[argparse.Namespace], int] = arguments.run
    try:
        return run(arguments)
    except (KeyboardInterrupt, isograft.Cancelled):
        return _tell(arguments, CANCELLED, "Cancelled", "cancelled")
    except (isograft.InvalidInput, BadInput) as error:
        return _tell(arguments, USAGE, "InvalidInput", str(error))
    except MemoryError as error:
        return _tell(arguments, FAILED, type(error).__name__, str(error) or "out of memory")
    except OSError as error:
        return _tell(arguments, FAILED, type(error).__name__, str(error))


def _tell(arguments: argparse.Namespace, code: int, kind: str, text: str) -> int:
    print(f"isograft {arguments.command}: {text}", file=sys.stderr)
    if arguments.json:
        print(json.dumps({"error": {"kind": kind, "text": text}, "exit_code": code}))
    return code


if __name__ == "__main__":
    sys.exit(main())

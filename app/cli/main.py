"""Command line for all that can be done without eyes, one subcommand per thing. Without any, the window opens.

Exit codes: 0 done, 2 bad usage or a file that is not what it states it is, 3 interrupted. Each subcommand is a module
of this package, imported when it is called: `--help` and the window come at once.
"""

import argparse
import io
import os
import sys
import warnings
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path

from app.cli.parser import REFUSED, SUBCOMMANDS, Parser, add_language, parser
from app.cli.progress import Progress
from app.system.logs import log_folder, start_logging
from app.wording.translation import use_language
from devices.files.refusal import FileRefusedError, one_line

if sys.platform != "win32":
    import resource

DONE, INTERRUPTED = 0, 3
MODULES = {"import": "import_files"}  # of the others it has the subcommand's name


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line and give the exit code; raises SystemExit after `--help` (0) or bad usage (2)."""
    # numpy is not imported yet: many small matrices are slower on many threads, and another program may want the cores
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a terminal without a degree sign is no reason to stop
    if argv is None:
        _begin_program()
    of_language = Parser(prog="gaitwright", add_help=False, allow_abbrev=False)
    add_language(of_language)
    spoken, arguments = of_language.parse_known_args(sys.argv[1:] if argv is None else argv)
    if not arguments or (len(arguments) == 1 and _is_folder(arguments[0])):
        return _open_window(arguments, spoken.lang)
    use_language(spoken.lang or "en")
    args = parser().parse_args(arguments)
    try:
        return _run(args)
    except KeyboardInterrupt:
        # where it fell into the `exec` of a text, as libraries have them, CPython would end this process by the signal
        # whatever code we give; the next `exec` of a text takes that back
        exec("")
        left = getattr(args, "stopped", f"{args.out} is as it was before.")
        return _say_last(f"Stopped. {left}", INTERRUPTED)


def _begin_program() -> None:
    """What the process as a whole needs, which tests do without."""
    start_logging(log_folder())
    if not sys.warnoptions:
        warnings.simplefilter("ignore")  # meant for developers; what concerns the clinician is a finding
    if sys.platform != "win32":
        # a core dump would hold the patients' data; Linux takes 1 for "not to another program either", 0 only for files
        highest = resource.getrlimit(resource.RLIMIT_CORE)[1]
        least = 1 if sys.platform == "linux" and highest != 0 else 0
        resource.setrlimit(resource.RLIMIT_CORE, (least, least))


def _run(args: argparse.Namespace) -> int:
    try:
        _print_lines(args)
    except FileRefusedError as refusal:
        return _say_last(str(refusal), REFUSED)
    except OSError as problem:  # readers put theirs into words, so this is OUT
        why = one_line(problem.strerror or str(problem))
        message = f"{one_line(str(args.out))}: this cannot be written ({why}). Make room or choose another --out."
        return _say_last(message, REFUSED)
    return DONE


def _print_lines(args: argparse.Namespace) -> None:
    """Do a subcommand, and print what it gives once its progress is out of the way: also before a refusal."""
    subcommand = import_module(f"app.cli.{MODULES.get(args.subcommand, args.subcommand)}")
    lines: list[str] = []
    try:
        with Progress(sys.stderr) as progress:
            for line in subcommand.run(args, progress):
                lines += [line]
    finally:
        print(*lines, sep="\n", end="\n" if lines else "")


def _say_last(message: str, code: int) -> int:
    print(message, file=sys.stderr)
    return code


def _is_folder(argument: str) -> bool:
    """Whether a session folder is named in place of a subcommand, whose name goes first."""
    return argument not in SUBCOMMANDS and Path(argument).is_dir()


def _open_window(arguments: list[str], language: str) -> int:
    variables = ("DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM")
    if sys.platform.startswith("linux") and not any(os.environ.get(name) for name in variables):
        return _say_last("There is no screen here. See gaitwright --help for what works without one.", REFUSED)
    from app.main_window import open_window  # Qt, which no subcommand needs

    return open_window(arguments, language)

"""Command line for all that can be done without eyes, one subcommand per thing. Without any, the window opens.

Exit codes: 0 done, 2 bad usage or a file that is not what it states it is, 3 interrupted. What takes long to import is
imported where it is used, so that `--help` and the window come at once.
"""

import argparse
import io
import math
import os
import sys
import warnings
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from app.cli.agree import add_agree_arguments, agree
from app.cli.batch import add_batch_arguments, batch
from app.cli.clinic import add_clinic_arguments, clinic
from app.cli.compare import add_compare_arguments, compare
from app.cli.devices import EMULATED
from app.cli.export import add_export_arguments, export
from app.cli.import_files import add_import_arguments, import_files
from app.cli.library import LibrarySession, add_key_arguments, session_place
from app.cli.progress import Progress, finding_lines, one_of, positive
from app.cli.query import add_query_arguments, query
from app.cli.repeatability import add_repeatability_arguments, repeatability
from app.cli.report import add_report_arguments, make
from app.storage.layout import default_folder
from app.system.logs import log_folder, start_logging, version_of
from app.wording.translation import languages, use_language

if TYPE_CHECKING:
    from app.cohort.batch.analysed_folder import AnalysisChoices
    from core.results import Analysis
    from core.session import Session

DONE, REFUSED, INTERRUPTED = 0, 2, 3

# as core.results.Method and core.published.angles have them, whose imports would cost half a second here
DEFAULT_TAU_S = 2.0
METHODS = ("robust", "published")
SUBCOMMANDS = (
    *("analyse", "demo", "report", "compare", "agree", "export", "import", "batch", "query"),
    *("repeatability", "clinic", "recover", "audit", "devices"),
)
OF_LIBRARY = "the folder of the library (your own)"


def main(argv: Sequence[str] | None = None) -> int:
    """Do what the command line asks for and give the exit code.

    Raises
    ------
    SystemExit
        After `--help` (0) and on bad usage (2).
    """
    # numpy is not imported yet: many small matrices are slower on many threads, and another program may want the cores
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a terminal without a degree sign is no reason to stop
    if argv is None:
        _begin_program()
    of_language = _Parser(prog="gaitwright", add_help=False, allow_abbrev=False)
    _add_language(of_language)
    spoken, arguments = of_language.parse_known_args(sys.argv[1:] if argv is None else argv)
    if not arguments or (len(arguments) == 1 and _is_folder(arguments[0])):
        return _open_window(arguments, spoken.lang)
    use_language(spoken.lang or "en")
    args = _parser().parse_args(arguments)
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
        import resource

        # a core dump would hold the patients' data; Linux takes 1 for "not to another program either", 0 only for files
        highest = resource.getrlimit(resource.RLIMIT_CORE)[1]
        least = 1 if sys.platform == "linux" and highest != 0 else 0
        resource.setrlimit(resource.RLIMIT_CORE, (least, least))


def _run(args: argparse.Namespace) -> int:
    from devices.files.refusal import FileRefusedError, one_line

    try:
        args.run(args)
    except FileRefusedError as refusal:
        return _say_last(str(refusal), REFUSED)
    except OSError as problem:  # readers put theirs into words, so this is OUT
        why = one_line(problem.strerror or str(problem))
        message = f"{one_line(str(args.out))}: this cannot be written ({why}). Make room or choose another --out."
        return _say_last(message, REFUSED)
    return DONE


def _say_last(message: str, code: int) -> int:
    print(message, file=sys.stderr)
    return code


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        """Refuse in one line, as everything else is refused."""
        plain = message.removeprefix("argument : ")  # the list of subcommands has no name
        self.exit(REFUSED, f"{self.prog}: {plain}. See {self.prog} --help.\n")


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="gaitwright",
        description="Knee and ankle angles from inertial sensors worn in any orientation. "
        "Without a subcommand the window opens, with a session folder if one is named.",
        epilog="Research use. Not a medical device.",
    )
    parser.add_argument("--version", action="version", version=f"gaitwright {version_of('gaitwright')}")
    _add_language(parser)
    commands = parser.add_subparsers(title="subcommands", metavar="", required=True)
    _add_analyse(commands.add_parser("analyse", help="compute the angles of a session"))
    _add_demo(commands.add_parser("demo", help="simulate a patient and analyse the session"))
    for name, what, add_arguments, work in (
        ("report", "make the report of a session as a PDF", add_report_arguments, make),
        ("compare", "list what differs between conditions or sessions", add_compare_arguments, compare),
        ("agree", "compare the angles of a session with an optical system", add_agree_arguments, agree),
        ("export", "write results for other programs", add_export_arguments, export),
        ("import", "add recordings of another program to a session", add_import_arguments, import_files),
        ("batch", "analyse all sessions of a folder or of the library", add_batch_arguments, batch),
        ("repeatability", "find your clinic's own error figures", add_repeatability_arguments, repeatability),
    ):
        subcommand = commands.add_parser(name, help=what)
        add_arguments(subcommand)
        subcommand.set_defaults(run=_telling(work))
    of_clinic = commands.add_parser("clinic", help="share a library between the stations of a clinic")
    add_clinic_arguments(of_clinic)
    of_clinic.set_defaults(run=_telling(clinic), library=default_folder(), out="What was on the way")
    asking = commands.add_parser("query", help="ask the table of a batch in SQL")
    add_query_arguments(asking)
    asking.set_defaults(run=_query)
    _add_recover(commands.add_parser("recover", help="close recordings that were interrupted"))
    _add_audit(commands.add_parser("audit", help="see whether a library's audit was changed"))
    _add_devices(commands.add_parser("devices", help="list the sensors found, and how drivers were tested"))
    return parser


def _add_language(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--lang",
        choices=languages(),
        default="",
        help="the language of the window, kept for its next start, and of reports and findings",
    )


def _add_analyse(parser: argparse.ArgumentParser) -> None:
    parser.description = "Compute knee and ankle angles of a session and write them as a folder of results."
    parser.add_argument(
        "session",
        metavar="SESSION",
        type=session_place,
        help="the session folder, or library:ID for one of the library",
    )
    parser.add_argument("--library", metavar="LIBRARY", type=Path, default=default_folder(), help=OF_LIBRARY)
    add_key_arguments(parser)
    parser.add_argument("--out", metavar="OUT", type=Path, required=True, help="the folder of results to write")
    parser.add_argument(
        "--method",
        type=one_of(METHODS),
        default=METHODS[0],
        metavar="{robust,published}",
        help="how joints are identified and which angle is the result (robust)",
    )
    parser.add_argument(
        "--tau",
        type=positive,
        default=DEFAULT_TAU_S,
        metavar="S",
        help="time constant of the published fusion in seconds (2)",
    )
    parser.add_argument("--no-report", action="store_true", help="write no report.pdf")
    parser.add_argument("--no-rrd", action="store_true", help="write no session.rrd for Rerun")
    parser.set_defaults(run=_analyse)


def _add_demo(parser: argparse.ArgumentParser) -> None:
    parser.description = "Simulate a patient with known angles, write the session and analyse it. The data are marked."
    parser.add_argument(
        "--out",
        metavar="OUT",
        type=Path,
        default=Path("gaitwright-demo"),
        help="the folder to write: OUT/session and its results in OUT (./gaitwright-demo)",
    )
    parser.set_defaults(run=_demo)


def _add_recover(parser: argparse.ArgumentParser) -> None:
    parser.description = "Find recordings that ended without being stopped, close them, and say what is in them."
    parser.add_argument("library", metavar="LIBRARY", type=Path, nargs="?", default=default_folder(), help=OF_LIBRARY)
    add_key_arguments(parser)
    parser.add_argument(
        "--into",
        type=LibrarySession.parsed,
        metavar="SESSION",
        help="the session (library:ID) for recordings that belong to none",
    )
    parser.set_defaults(run=_recover, out="What was not yet recovered")


def _add_audit(parser: argparse.ArgumentParser) -> None:
    parser.description = (
        "Follow the audit of a library from its beginning, and print how far it goes. That line, kept elsewhere, shows "
        "later whether the end is missing."
    )
    parser.add_argument("library", metavar="LIBRARY", type=Path, nargs="?", default=default_folder(), help=OF_LIBRARY)
    add_key_arguments(parser)
    parser.add_argument("--since", metavar="LINE", default="", help="what this command printed an earlier time")
    parser.set_defaults(run=_verify_audit, out="The audit")


def _add_devices(parser: argparse.ArgumentParser) -> None:
    parser.description = "List the sensors found at ports and on the network, and how each driver was tested."
    parser.add_argument(
        "--emulate",
        type=one_of(EMULATED),
        metavar="{" + ",".join(EMULATED) + "}",
        help="play sensors that are not there instead, and print their ports",
    )
    parser.add_argument(
        "--streams",
        nargs="?",
        const="127.0.0.1",
        default="",
        metavar="ADDRESS",
        help="ask for streams, too: on this computer, or in the network where it has this address",
    )
    parser.add_argument(
        "--count", type=int, default=6, metavar="N", help="how many are played (6); the seventh is on the pelvis"
    )
    parser.add_argument(
        "--seconds", type=positive, default=math.inf, metavar="S", help="for how long they are played (until Ctrl C)"
    )
    parser.set_defaults(run=_devices, out="The port of an emulated sensor")


def _analyse(args: argparse.Namespace) -> None:
    from app.cohort.batch.analysed_folder import write_analysed
    from app.exports.result_folder import OWN_SESSION, check_place, written_beside

    place = args.library if isinstance(args.session, LibrarySession) else args.session
    check_place(args.out, place)
    session_is_inside = place.resolve() == args.out.resolve() / OWN_SESSION
    with Progress(sys.stderr) as progress, written_beside(args.out, keeps_session=session_is_inside) as folder:
        progress(0.0, str(args.session))
        session = _read(args, progress)
        analysis = write_analysed(session, folder, _choices(args), progress)
    _show_message(analysis, args.out)


def _read(args: argparse.Namespace, progress: Progress) -> "Session":
    if isinstance(args.session, LibrarySession):
        from app.cli.library import read_library_session

        return read_library_session(args, args.session, progress)
    from app.importing.untrusted_files import read_foreign_session

    return read_foreign_session(args.session, lambda: progress(0.0, str(args.session)))


def _recover(args: argparse.Namespace) -> None:
    from app.cli.library import recover

    lines: list[str] = []
    try:
        with Progress(sys.stderr) as progress:
            for line in recover(args, progress):
                lines += [line]
    finally:  # also before a refusal
        print(*lines, sep="\n", end="\n" if lines else "")


def _verify_audit(args: argparse.Namespace) -> None:
    from app.cli.library import verify_audit

    for line in verify_audit(args):
        print(line)


def _devices(args: argparse.Namespace) -> None:
    from app.cli.devices import emulate, list_devices

    if args.emulate:
        emulate(args.emulate, args.count, args.seconds, lambda line: print(line, flush=True), sys.stdin)
        return
    for line in list_devices(args.streams):
        print(line)


def _demo(args: argparse.Namespace) -> None:
    from app.cohort.batch.analysed_folder import AnalysisChoices, write_analysed
    from app.exports.result_folder import OWN_SESSION, check_demonstration_place, written_beside
    from app.system.tables import write_table
    from core.results import Method
    from devices.files.session_folder import read_session, write_session
    from devices.simulation.walker import DEMONSTRATION, simulate, truth_table

    check_demonstration_place(args.out)
    with Progress(sys.stderr) as progress, written_beside(args.out) as folder:
        progress(0.0, "simulated patient")
        simulated = simulate(DEMONSTRATION)
        write_session(simulated.session, folder / OWN_SESSION)
        write_table(*truth_table(simulated.truth), folder / OWN_SESSION / "truth.csv")
        session = read_session(folder / OWN_SESSION)  # so that `analyse` gives the same bytes
        analysis = write_analysed(session, folder, AnalysisChoices(Method(METHODS[0]), DEFAULT_TAU_S), progress)
    _show_message(analysis, args.out)


def _telling(work: Callable[[argparse.Namespace, Progress], Iterable[str]]) -> Callable[[argparse.Namespace], None]:
    """Do a subcommand that gives its lines for the terminal."""

    def run(args: argparse.Namespace) -> None:
        with Progress(sys.stderr) as progress:
            lines = list(work(args, progress))
        print(*lines, sep="\n")

    return run


def _query(args: argparse.Namespace) -> None:
    """Print an answer while it comes, which may be larger than memory, until nobody reads it any more."""
    with Progress(sys.stderr):  # for its hold on Ctrl C; there is nothing to be reported meanwhile
        try:
            for line in query(args):
                print(line)
            sys.stdout.flush()
        except BrokenPipeError:  # as of `| head`
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _choices(args: argparse.Namespace) -> "AnalysisChoices":
    from app.cohort.batch.analysed_folder import AnalysisChoices
    from core.results import Method

    return AnalysisChoices(Method(args.method), args.tau, not args.no_report, not args.no_rrd)


def _show_message(analysis: "Analysis", out: Path) -> None:
    """Say where the results are and what needs a look."""
    from app.wording.body import name_of

    joints = [joint for span in analysis.calibrations for joint in span.joints]
    names = ", ".join(name_of(joint) for joint in dict.fromkeys(joints)) or "no joint"
    count = len(analysis.recordings)
    print(f"{out}: {names}; {count} {'recording' if count == 1 else 'recordings'}.")
    for line in finding_lines(analysis.findings, lowest="warning"):
        print(line)


def _is_folder(argument: str) -> bool:
    """Whether a session folder is named in place of a subcommand, whose name goes first."""
    return argument not in SUBCOMMANDS and Path(argument).is_dir()


def _open_window(arguments: list[str], language: str) -> int:
    variables = ("DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM")
    if sys.platform.startswith("linux") and not any(os.environ.get(name) for name in variables):
        return _say_last("There is no screen here. See gaitwright --help for what works without one.", REFUSED)
    from app.main_window import open_window

    return open_window(arguments, language)

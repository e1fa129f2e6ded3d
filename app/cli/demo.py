"""`gaitwright demo`: a simulated patient with known angles, and what `analyse` makes of it."""

import argparse
from collections.abc import Iterator

from app.cli.analyse import lines_of, lines_without_log
from app.cohort.batch.analysed_folder import AnalysisChoices, write_analysed
from app.exports.result_folder import OWN_SESSION, check_demonstration_place, written_beside
from app.system.progress import Report
from app.system.tables import write_table
from core.published.angles import DEFAULT_TAU_S
from core.results import Method
from devices.files.session_folder import read_session, write_session
from devices.simulation.walker import DEMONSTRATION, simulate, truth_table


def run(args: argparse.Namespace, report: Report) -> Iterator[str]:
    """Write the session and its results, and give the lines for the terminal.

    Raises
    ------
    FileRefusedError
        Something else is at OUT.
    OSError
        OUT cannot be written.
    """
    check_demonstration_place(args.out)
    with written_beside(args.out) as folder:
        report(0.0, "simulated patient")
        simulated = simulate(DEMONSTRATION)
        write_session(simulated.session, folder / OWN_SESSION)
        write_table(*truth_table(simulated.truth), folder / OWN_SESSION / "truth.csv")
        session = read_session(folder / OWN_SESSION)  # so that `analyse` gives the same bytes
        choices = AnalysisChoices(Method.ROBUST, DEFAULT_TAU_S)
        analysis = write_analysed(session, folder, choices, report)
    yield from lines_of(analysis, args.out)
    yield from lines_without_log(choices)

"""`gaitwright compare`: what differs between conditions or sessions, as a table on the terminal and as a CSV file."""

import argparse
import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from pathlib import Path

from app.cli.analyse import form_of
from app.cli.arguments import DIFFERENCES
from app.cli.places import read_place
from app.exports.local_csv import rewrite_tables
from app.exports.result_folder import written_beside
from app.summary.comparison import Comparison
from app.summary.conditions import Part
from app.summary.differences import comparisons_of, rows_of, without_common_condition, write_differences
from app.summary.visits import WalkedVisit, conditions_in_words
from app.system.progress import Report
from core.analysis import analyse
from core.results import Analysis
from core.session import Session
from core.verdicts.measurement_error import Difference
from devices.files.refusal import FileRefusedError, one_line

FLAGS = {  # as core.verdicts.measurement_error has them
    "exceeds_error": "beyond measurement error",
    "inside_error": "may be measurement error",
    "too_few_strides": "too few strides",
    "no_published_figure": "not judged",
    "withheld": "not reported",
}
DAGGER = "†"
DAGGER_MEANS = f"{DAGGER} The error rests on a figure of which the source could not be checked."


def run(args: argparse.Namespace, report: Report) -> list[str]:
    """Write the table and give the lines for the terminal.

    Raises
    ------
    FileRefusedError
        A session cannot be read, nothing can be compared, or something else is at OUT.
    OSError
        The table cannot be written.
    """
    _check_place(args.out)
    form = form_of(args)
    visits = []
    for number, place in enumerate(args.sessions):

        def reported(share: float, what: str, number: int = number) -> None:
            report((number + share) / len(args.sessions), what)

        session = read_place(args, place, reported)
        visits.append((session, analyse(session, progress=reported)))
    comparisons = comparisons_of(visits)
    rows = [row for comparison in comparisons for row in rows_of(comparison)]
    alone = [_not_compared(args.sessions[number - 1], visits) for number in without_common_condition(visits)]
    if not rows:
        names = ", ".join(one_line(str(place)) for place in args.sessions)
        if alone:
            raise FileRefusedError(names, " ".join(alone), "Give sessions that share a walking condition")
        what = "there are no two conditions, nor two sessions, with strides in both"
        raise FileRefusedError(names, what, "Give two sessions, or one with two conditions")
    with written_beside(args.out) as folder:
        write_differences(rows, folder / DIFFERENCES)
        rewrite_tables(folder, form)
        report(1.0, "writing")
    return [
        *(line for comparison in comparisons for line in _table(comparison, dict(args.limit))),
        *(["", *alone] if alone else []),
        *(["", DAGGER_MEANS] if any(row.difference.is_unverified for row in rows) else []),
        "",
        f"{args.out / DIFFERENCES}: {len(rows)} differences. Research use. Not a medical device.",
    ]


def _not_compared(place: object, visits: Sequence[tuple[Session, Analysis]]) -> str:
    walked = [
        WalkedVisit(f"session {number}", analysis, session.recordings)
        for number, (session, analysis) in enumerate(visits, 1)
    ]
    name = one_line(str(place))
    return f"{name} has no condition in common with the first, so they are not compared. {conditions_in_words(walked)}"


def _check_place(out: Path) -> None:
    """See whether a comparison may stand at `out`: nothing is there, or only a comparison."""
    if out.exists() and not (out.is_dir() and {path.name for path in out.iterdir()} <= {DIFFERENCES}):
        raise FileRefusedError(str(out), "this already exists and is not a comparison", "Choose another --out")


def _table(comparison: Comparison, limits: Mapping[str, float]) -> Iterator[str]:
    simulated = "SIMULATED. " if comparison.is_simulated else ""
    for _, of_part in groupby(rows_of(comparison), key=lambda row: row.part.letter):
        rows = list(of_part)
        yield f"{simulated}{_named(rows[0].part)} less {_named(comparison.against)}"
        yield f"  {'':5} {'':38} {'one':>9} {'other':>9} {'differs':>9} {'likely between':>18}"
        for row in rows:
            side = "" if row.side is None else row.side.letter
            found = row.difference
            figures = (row.value.mean, row.other.mean, found.difference)
            cells = " ".join(f"{_short(figure):>9}" for figure in figures)
            mark = DAGGER if found.is_unverified else " "
            likely = " to ".join(map(_short, found.interval)) if found.is_judged else ""
            often = _often(found, limits.get(row.parameter))
            yield f"  {side:5} {row.parameter:38} {cells} {likely:>18}{mark} {FLAGS[found.judgement]}{often}"


def _often(found: Difference, limit: float | None) -> str:
    """In how many of 10 such measurements a change is as large as one that matters."""
    if limit is None or not found.is_judged:
        return ""
    return f"; {limit:g} or more in {10 * found.share_of_at_least(limit):.0f} of 10 such measurements"


def _named(part: Part) -> str:
    return f"{part.letter} {one_line(part.name)}"


def _short(value: float) -> str:
    return f"{round(value, 2) + 0.0:.2f}" if math.isfinite(value) else ""  # no minus before zero

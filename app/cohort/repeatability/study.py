"""A study of repeatability from its sessions to its figures, and the files that hold them."""

import json
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

from app.cohort.repeatability.people import StudyPeople
from app.cohort.repeatability.table import HEADS, csv_rows
from app.system.logs import version_of
from app.system.progress import Report
from app.system.tables import write_table
from app.wording.translation import tr
from core.results import Analysis
from core.session import Session
from core.verdicts.own_figures import MIN_PEOPLE, OwnFigures, figures_from_text, figures_in_json
from core.verdicts.repeatability import TooFewPeopleError
from devices.files.refusal import FileRefusedError

FIGURES, TABLE = "repeatability.json", "repeatability.csv"
MOST_BYTES = 1_000_000

Read = Callable[[Report], tuple[Session, Analysis]]
"""Reads one session and analyses it, or finds what came of it before."""


@dataclass(frozen=True, slots=True)
class StudyResult:
    """What was found, and what was left out, a sentence each."""

    own: OwnFigures
    notes: tuple[str, ...]


def study(
    where: str, sessions: Iterable[tuple[str, Read]], people: StudyPeople, made_by: str, report: Report
) -> StudyResult:
    """Read all sessions and find what attachments differ by; raises FileRefusedError also for too few people."""
    listed = list(sessions)
    for number, (name, read) in enumerate(listed):

        def reported(share: float, _what: str, number: int = number, name: str = name) -> None:
            report((number + share) / len(listed), name)

        people.add(*read(reported))
    try:
        own = people.figures(made_by, version_of("gaitwright"))
    except TooFewPeopleError as few:
        what = tr("{count} of the {least} people needed were measured with the sensors attached twice").format(
            count=few.people, least=MIN_PEOPLE
        )
        raise FileRefusedError(where, " ".join([what, *people.notes()]), _remedy(people)) from few
    return StudyResult(own, tuple(people.notes()))


def _remedy(people: StudyPeople) -> str:
    if people.condition:
        return tr("Record each person twice, with the condition “{condition}”").format(condition=people.condition)
    return tr("Record each person twice, under the same patient code and condition")


def write_figures(own: OwnFigures, folder: Path) -> None:
    """Write the figures as JSON and as a table; raises OSError."""
    text = json.dumps(figures_in_json(own), indent=2, allow_nan=False)
    (folder / FIGURES).write_text(text + "\n", encoding="utf-8", newline="\n")
    write_table(HEADS, csv_rows(own), folder / TABLE)


def read_figures(path: Path) -> OwnFigures:
    """Read what `write_figures` wrote; raises FileRefusedError."""
    remedy = tr("Choose the {file} written by the command “gaitwright repeatability”").format(file=FIGURES)
    try:
        if path.stat().st_size > MOST_BYTES:
            raise FileRefusedError(str(path), tr("this file is no study of repeatability"), remedy)
        return figures_from_text(path.read_text(encoding="utf-8"))
    except OSError as problem:
        what = tr("this file cannot be read ({why})").format(why=problem.strerror)
        raise FileRefusedError(str(path), what, remedy) from problem
    except ValueError as problem:  # also of text that is no UTF-8, or no JSON
        raise FileRefusedError(str(path), tr("this file is no study of repeatability"), remedy) from problem

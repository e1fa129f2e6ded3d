"""Whose walks belong to a study of repeatability, and what of them is compared."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from app.cohort.repeatability.people import CONDITION, StudyPeople
from app.cohort.repeatability.study import FIGURES, TABLE, read_figures, study, write_figures
from app.cohort.repeatability.table import ATTACHED_AGAIN, BETWEEN_LEGS, HEADS, csv_rows, rows_of
from core.parameters import SPEED, STANCE, QuantityKind
from core.results import Analysis
from core.session import Patient, Session
from core.verdicts.own_figures import Between, OwnEstimate, OwnFigures, OwnSigma
from core.verdicts.repeatability import TooFewPeopleError
from devices.files.refusal import FileRefusedError
from tests.app.course_material import analysis, recordings, walked

STANCES = ((60.0, 61.0), (59.0, 61.5), (60.5, 60.0), (61.0, 59.0), (60.0, 58.5))
Visit = tuple[Session, Analysis]


def visit(
    code: str,
    *stances: float,
    conditions: Sequence[str] = (),
    day: str = "2026-11-12",
    patient: Patient | None = None,
    restrapped: Sequence[int] = (1,),
) -> Visit:
    """A session with a walk for each stance; before those of the numbers `restrapped` sensors were attached again."""
    walks = [walked(f"walk {number}", stance_percent=stance) for number, stance in enumerate(stances, 1)]
    named = zip(walks, conditions or [""] * len(walks), strict=True)
    reported = [
        replace(one, is_restrapped_before=number in restrapped) for number, one in enumerate(recordings(*named))
    ]
    of = replace(patient or Patient(), code=code)
    return Session(tuple(reported), patient=of, started=f"{day}T10:00:00"), analysis(*walks)


def figures(*visits: Visit, condition: str = "") -> OwnFigures:
    people = StudyPeople(condition)
    for one in visits:
        people.add(*one)
    return people.figures("hk", "1.0")


def five() -> list[Visit]:
    return [visit(f"H-{number}", *stances) for number, stances in enumerate(STANCES)]


def stance(own: OwnFigures) -> OwnEstimate:
    return own.sigmas[QuantityKind.STANCE].sigma


def test_two_attachments_in_one_session_are_those_of_two_sessions() -> None:
    twice = [
        visit(f" h-{number}" if k else f"H-{number}", stances[k], day=f"2026-11-1{k}")
        for number, stances in enumerate(STANCES)
        for k in range(2)
    ]
    one, other = figures(*five()), figures(*twice)
    assert stance(one) == pytest.approx(stance(other))
    assert (one.between, other.between) == (Between.STRAPPINGS, Between.DAYS)
    assert (one.people, one.made_by, one.software, one.days) == (5, "hk", "1.0", ("2026-11-12", "2026-11-12"))
    assert {SPEED, STANCE} <= {row.column for row in rows_of(one)}


def test_walks_of_one_attachment_are_taken_together_and_no_measure_of_attaching() -> None:
    with pytest.raises(TooFewPeopleError):
        figures(*(visit(f"H-{number}", *stances, restrapped=()) for number, stances in enumerate(STANCES)))


def test_walks_of_different_conditions_are_not_compared() -> None:
    with pytest.raises(TooFewPeopleError):
        figures(*(visit(f"H-{n}", *stances, conditions=("slow", "fast")) for n, stances in enumerate(STANCES)))


def test_of_a_library_walks_of_the_condition_alone_count_however_it_is_written() -> None:
    named = [
        visit(f"H-{n}", *stances, conditions=("Repeatability", " repeatability")) for n, stances in enumerate(STANCES)
    ]
    assert stance(figures(*named, condition=CONDITION)) == pytest.approx(stance(figures(*five())))
    patients = [visit(f"P-{n}", 40.0, 70.0, conditions=("shoes", "shoes")) for n in range(6)]
    assert stance(figures(*named, *patients, condition=CONDITION)) == stance(figures(*named, condition=CONDITION))
    with pytest.raises(TooFewPeopleError):
        figures(*patients, condition=CONDITION)


def test_people_with_an_affected_or_prosthetic_side_and_sessions_without_a_code_are_left_out_and_named() -> None:
    people = StudyPeople()
    for one in five():
        people.add(*one)
    before = people.figures("", "")
    people.add(*visit("P-1", 40.0, 70.0, patient=Patient(affected_side="left")))
    people.add(*visit("P-2", 40.0, 70.0, patient=Patient(prosthetic_side="both")))
    people.add(*visit("", 40.0, 70.0))
    people.add(*visit("H-9", 40.0))
    assert people.figures("", "") == before
    assert list(people.notes()) == [
        "1 session without a patient code is excluded.",
        "2 people with an affected or prosthetic side are excluded.",
        "1 person was measured only once and is excluded.",
    ]
    people.add(*visit("H-8", 60.0, 61.0, patient=Patient(affected_side="none")))
    assert people.figures("", "").people == 6


def test_too_few_people_are_refused_with_how_many_and_what_to_do() -> None:
    def refused(people: StudyPeople) -> str:
        visits = [(session.patient.code, lambda _report, one=(session, found): one) for session, found in five()[:4]]
        with pytest.raises(FileRefusedError) as refusal:
            study("clinic", visits, people, "", lambda _share, _what: None)
        return str(refusal.value)

    assert refused(StudyPeople()) == (
        "clinic: 4 of the 5 people needed were measured with the sensors attached twice. Record each person twice, "
        "under the same patient code and condition."
    )
    assert "0 of the 5 people" in refused(StudyPeople(CONDITION))


def test_files_hold_what_was_found_and_another_file_is_refused(tmp_path: Path) -> None:
    own = figures(*five())
    write_figures(own, tmp_path)
    assert stance(read_figures(tmp_path / FIGURES)) == pytest.approx(stance(own))
    assert (tmp_path / TABLE).read_text(encoding="utf-8").splitlines()[0] == ",".join(HEADS)
    for content in (b"{}", b"\xff\xfe", b"[" * 100_000, b"none", b'{"format": "gaitwright-repeatability/1"}'):
        (tmp_path / FIGURES).write_bytes(content)
        with pytest.raises(FileRefusedError, match="is no study of repeatability"):
            read_figures(tmp_path / FIGURES)
    with pytest.raises(FileRefusedError, match="cannot be read"):
        read_figures(tmp_path / "gone.json")


def test_a_row_states_whether_the_published_figure_is_within_the_own_limits() -> None:
    def row(own: float, low: float, high: float) -> tuple[str, str]:
        found = OwnFigures(
            12,
            Between.DAYS,
            {QuantityKind.STANCE: OwnSigma(OwnEstimate(own, low, high, 12), 61.0, 1.1)},
            {STANCE: OwnEstimate(4.0, 3.0, 5.5, 12)},
        )
        again, legs = rows_of(found)
        assert (again.group, legs.group, legs.is_within) == (ATTACHED_AGAIN, BETWEEN_LEGS, True)
        return again.verdict, next(csv_rows(found))[-1]

    assert row(1.0, 0.8, 1.3) == ("within limits", "true")
    assert row(2.0, 1.5, 2.9) == ("own is higher", "false")
    assert row(0.5, 0.4, 0.7) == ("own is lower", "false")

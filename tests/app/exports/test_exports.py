"""Tests that an export leaves without names, noted in the library it comes from, whole or not at all."""

import datetime
import io
import json
import os
import stat
import zipfile
from dataclasses import replace
from pathlib import Path
from uuid import uuid4

import pytest

from app.exports import exports, folder_pseudonyms
from app.exports.exports import (
    Format,
    export_from_folder,
    export_from_library,
    preview_from_folder,
    preview_from_library,
)
from app.storage.audit import about
from app.storage.exchange import import_session
from app.storage.journal.disk import Room
from app.storage.opened import OpenedLibrary
from app.storage.pseudonyms import Pseudonyms, Typed, age_in_words
from app.storage.stored import Action, LibraryError
from app.system.progress import nobody
from core.alignment import AlignmentChange, PartChange, ProsthesisPart
from core.goals import Goal, GoalOf
from core.session import Session
from core.timed.protocols import PlannedTest, TimedProtocol
from devices.files.refusal import FileRefusedError
from devices.files.session_folder import write_session
from tests.app.exports.conftest import Visit
from tests.quick_library import quick_library

NAME = "Miller"


def everything_in(folder: Path) -> str:
    """Every file's path and content, that of a workbook unpacked."""
    stated = []
    for file in sorted(path for path in folder.rglob("*") if path.is_file()):
        content = file.read_bytes()
        if content.startswith(b"PK"):
            archive = zipfile.ZipFile(io.BytesIO(content))
            content = b"".join(archive.read(name) for name in archive.namelist())
        stated.append(f"{file.relative_to(folder)}{content.decode('utf-8', 'replace')}")
    return "".join(stated)


def files_in(folder: Path) -> list[str]:
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())


@pytest.fixture
def opened(tmp_path: Path) -> OpenedLibrary:
    folder = tmp_path / "library"
    folder.mkdir()
    return quick_library(folder)


@pytest.mark.endurance
@pytest.mark.parametrize("required", Format)
def test_no_name_leaves_unless_identity_is_asked_for(visit: Visit, tmp_path: Path, required: Format) -> None:
    for name in ("nameless", "again", "identified"):
        (tmp_path / name).mkdir()
        export_from_folder(*visit, [required], tmp_path / name, is_identified=name == "identified")
    stated = everything_in(tmp_path / "nameless")
    assert NAME not in stated
    assert "2026-11-21" not in stated
    assert "SIMULATED" in stated
    assert NAME in everything_in(tmp_path / "identified")


PLANTED = {
    Typed.DEVICE: "Kniegelenk-Qx1",
    Typed.AIDS: "Gehstock-Qx2",
    Typed.SURFACE: "Flurboden-Qx3",
    Typed.CONDITIONS: "Ausrichtung-Qx4",
    Typed.CHANGES: "Keil-Qy1",
}
CHANGED = PartChange(
    ProsthesisPart.PYLON,
    height_mm=3.0,
    text=PLANTED[Typed.CHANGES],
    program_before=PLANTED[Typed.CHANGES],
    program=PLANTED[Typed.CHANGES],
    setting=PLANTED[Typed.CHANGES],
    setting_value=7.0,
)
NEVER = ("Operateur-Qx5", "Notiz-Qx6", "Programm-Qx7", "Uhr-Qx8", "Geschlecht-Qx9", "birth", NAME)
AGREED = Goal(
    *("speed_m_s", GoalOf.WALK, 1.2, datetime.date(2026, 1, 5), NEVER[0], False, f"as {NAME} wants"),
    until=datetime.date(2026, 1, 5) + datetime.timedelta(weeks=12),
)


@pytest.fixture(scope="session")
def planted(visit: Visit) -> Visit:
    """The visit with a word in everything that can be typed."""
    session, analysis = visit
    operator, notes, software, clock, sex, *_ = NEVER
    session = replace(
        session,
        patient=replace(
            session.patient,
            device=PLANTED[Typed.DEVICE],
            aids=PLANTED[Typed.AIDS],
            sex=sex,
            unknown={"name": NAME},
            goals=(AGREED,),
        ),
        recordings=tuple(
            replace(
                r,
                condition=PLANTED[Typed.CONDITIONS],
                alignment=AlignmentChange(PLANTED[Typed.CONDITIONS], (CHANGED,), PLANTED[Typed.CONDITIONS]),
            )
            for r in session.recordings
        ),
        sensors={site: replace(info, clock=clock) for site, info in session.sensors.items()},
        surface=PLANTED[Typed.SURFACE],
        operator=operator,
        notes=notes,
        software=software,
    )
    return session, analysis


@pytest.mark.endurance
@pytest.mark.parametrize("kept", [(), *((one,) for one in Typed), tuple(Typed)])
def test_what_is_typed_freely_leaves_only_where_it_is_ticked(
    planted: Visit, tmp_path: Path, kept: tuple[Typed, ...]
) -> None:
    """In every byte of every file, and in what is shown before."""
    export_from_folder(*planted, list(Format), tmp_path, kept=kept)
    write_session(Pseudonyms(bytes(32)).session(uuid4(), planted[0], kept), tmp_path / "session")
    shown = " ".join(str(value) for _, value in preview_from_folder(planted[0], kept))
    for stated in (everything_in(tmp_path), shown):
        assert [one for one, word in PLANTED.items() if word in stated] == list(kept)
        assert not [word for word in NEVER if word in stated]


def test_a_goal_leaves_with_its_figures_and_not_with_who_agreed_on_it(planted: Visit) -> None:
    own, patient_id = Pseudonyms(bytes(32)), uuid4()
    (goal,) = own.session(patient_id, planted[0]).patient.goals
    assert (goal.by, goal.note, goal.ended_by) == ("", "", "")
    assert (goal.key, goal.value) == (AGREED.key, AGREED.value)
    assert goal.agreed.isoformat() == own.shifted(patient_id, AGREED.agreed.isoformat()) != AGREED.agreed.isoformat()
    assert goal.until is not None
    assert goal.until - goal.agreed == datetime.timedelta(weeks=12)


def test_what_was_turned_leaves_with_its_figures_and_not_with_the_words(planted: Visit) -> None:
    reported = Pseudonyms(bytes(32)).session(uuid4(), planted[0]).recordings[0].alignment
    figures = PartChange(ProsthesisPart.PYLON, height_mm=3.0)
    assert reported == AlignmentChange("condition 1", (figures,), returns_to="condition 1")
    words = AlignmentChange("", (PartChange(ProsthesisPart.OTHER, text="a wedge"),))
    only_words = replace(planted[0], recordings=(replace(planted[0].recordings[0], alignment=words),))
    assert Pseudonyms(bytes(32)).session(uuid4(), only_words).recordings[0].alignment is None


def test_which_test_a_walk_is_leaves_with_the_instants_of_its_keys(planted: Visit) -> None:
    test = PlannedTest(TimedProtocol.TEN_METRES, end_key_s=9.5)
    timed = replace(planted[0], recordings=(replace(planted[0].recordings[0], test=test),))
    assert Pseudonyms(bytes(32)).session(uuid4(), timed).recordings[0].test == test
    assert Pseudonyms(bytes(32)).session(uuid4(), planted[0]).recordings[0].test is None


def test_all_that_was_typed_leaves_with_identity(planted: Visit, tmp_path: Path) -> None:
    """So that the words that must not leave above are words that could."""
    export_from_folder(*planted, [Format.XLSX, Format.FHIR], tmp_path, is_identified=True)
    stated = everything_in(tmp_path)
    assert not [word for word in (*PLANTED.values(), NEVER[0], NEVER[1], "birth", NAME) if word not in stated]


def test_an_age_leaves_in_place_of_the_year_of_birth(planted: Visit, tmp_path: Path) -> None:
    export_from_folder(*planted, [Format.XLSX, Format.FHIR], tmp_path)
    assert ("age, years", "76") in preview_from_folder(planted[0])
    about = everything_in(tmp_path)
    assert "age, years" in about
    resources = [one["resource"] for one in json.loads((tmp_path / "fhir_bundle.json").read_text())["entry"]]
    assert "birthDate" not in resources[0]
    (age,) = (one for one in resources if one.get("code", {}).get("text") == "age")
    assert age["valueQuantity"]["value"] == 76


def test_people_of_ninety_and_more_are_of_one_age(planted: Visit, tmp_path: Path) -> None:
    session, analysis = planted
    for born, age in ((1937, "89"), (1936, "90+"), (1920, "90+"), (2027, ""), (None, "")):
        assert age_in_words(replace(session, patient=replace(session.patient, birth_year=born))) == age
    export_from_folder(
        replace(session, patient=replace(session.patient, birth_year=1920)), analysis, [Format.FHIR], tmp_path
    )
    resources = [one["resource"] for one in json.loads((tmp_path / "fhir_bundle.json").read_text())["entry"]]
    (age,) = (one for one in resources if one.get("code", {}).get("text") == "age")
    assert (age["valueQuantity"]["value"], age["valueQuantity"]["comparator"]) == (90, ">=")


def test_conditions_without_their_words_are_numbered(planted: Visit) -> None:
    session = planted[0]
    typed = ("Anna barefoot", "", "Anna barefoot", "shoes of Bob")
    recordings = tuple(
        replace(session.recordings[0], name=str(number), condition=one) for number, one in enumerate(typed)
    )
    reported = Pseudonyms(bytes(32)).session(uuid4(), replace(session, recordings=recordings))
    assert [one.condition for one in reported.recordings] == ["condition 1", "", "condition 1", "condition 2"]


def code_of(session: Session) -> object:
    (code,) = (value for name, value in preview_from_folder(session) if name == "patient")
    return code


def test_a_session_of_no_library_gets_the_same_pseudonym_in_every_export_of_this_computer(
    visit: Visit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    session, analysis = visit
    stated = []
    for name in ("one", "other"):
        (tmp_path / name).mkdir()
        export_from_folder(session, analysis, [Format.FHIR, Format.BIDS], tmp_path / name)
        stated.append(everything_in(tmp_path / name))
    assert stated[0] == stated[1]
    assert str(code_of(session)) in stated[0]
    # it is of what was measured, and of this computer
    assert code_of(replace(session, patient=replace(session.patient, code="DEMO-7"))) == code_of(session)
    assert code_of(replace(session, recordings=session.recordings[1:])) != code_of(session)
    here = code_of(session)
    monkeypatch.setattr(folder_pseudonyms, "key_file", lambda: tmp_path / "another" / "pseudonyms.key")
    assert code_of(session) != here
    assert stat.S_IMODE((tmp_path / "another" / "pseudonyms.key").stat().st_mode) & 0o077 == 0 or os.name == "nt"


def test_where_no_key_can_be_kept_an_export_is_made_all_the_same(
    visit: Visit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setattr(folder_pseudonyms, "key_file", lambda: tmp_path / "file" / "pseudonyms.key")
    assert code_of(visit[0]) != code_of(visit[0])


def test_a_library_notes_what_left_it_and_gives_the_same_pseudonym(
    visit: Visit, opened: OpenedLibrary, tmp_path: Path
) -> None:
    session, analysis = visit
    with opened:
        room = Room(start_bytes=0, kept_bytes=0)
        session_id = import_session(opened, session, nobody, code=f"DEMO-{NAME}", room=room).session_id
        stated = []
        for name in ("one", "other"):
            (tmp_path / name).mkdir()
            formats = [Format.FHIR, Format.MOT]
            export_from_library(opened, session_id, formats, tmp_path / name, {}, nobody, analysed=lambda _: analysis)
            stated.append(everything_in(tmp_path / name))
        assert stated[0] == stated[1]
        assert NAME not in stated[0]
        noted = opened.library.audit.entries(about("session", session_id))
        reported = [json.loads(entry.details) for entry in noted if entry.action == Action.EXPORT]
        assert [one["format"] for one in reported] == ["fhir", "mot", "fhir", "mot"]
        assert not any(one["is_identified"] or one["typed"] for one in reported)
        shown = preview_from_library(opened, session_id)
        assert all(str(value) in stated[0] for name, value in shown if name in ("patient", "sex"))
        assert NAME not in str(shown)
        export_from_library(
            opened,
            session_id,
            [Format.XLSX],
            tmp_path,
            {},
            nobody,
            analysed=lambda _: analysis,
            kept=[Typed.CONDITIONS],
        )
        noted = opened.library.audit.entries(about("session", session_id))
        assert json.loads(noted[-1].details)["typed"] == "conditions"
        with pytest.raises(LibraryError):
            export_from_library(opened, uuid4(), [Format.MOT], tmp_path, {}, nobody)


def test_files_lie_as_those_of_the_analysis(visit: Visit, tmp_path: Path) -> None:
    export_from_folder(*visit, list(Format), tmp_path)
    assert [name for name in files_in(tmp_path) if not name.startswith("bids/")] == [
        "fhir_bundle.json",
        "free_motion/angles.c3d",
        "free_motion/angles.mot",
        "free_motion/orientations.sto",
        "gaitwright.xlsx",
        "standing/orientations.sto",
        "walk_1/angles.c3d",
        "walk_1/angles.mot",
        "walk_1/orientations.sto",
    ]


def test_a_format_that_fails_takes_no_other_with_it(
    visit: Visit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object, **__: object) -> str:
        raise RuntimeError("what its library threw")

    monkeypatch.setattr("app.exports.c3d_angles.write_c3d", fail)
    lines = export_from_folder(*visit, [Format.C3D, Format.MOT, Format.XLSX], tmp_path)
    assert lines == ["c3d: this format could not be written (what its library threw)"]
    assert files_in(tmp_path) == ["free_motion/angles.mot", "gaitwright.xlsx", "walk_1/angles.mot"]
    with pytest.raises(FileRefusedError, match="could not be written"):
        export_from_folder(*visit, [Format.C3D], tmp_path)


def test_a_missing_library_is_reported_before_anything_is_done(
    visit: Visit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(exports, "find_spec", lambda name: None)
    with pytest.raises(FileRefusedError, match="ezc3d"):
        export_from_folder(*visit, [Format.C3D], tmp_path)
    export_from_folder(*visit, [Format.FHIR], tmp_path)

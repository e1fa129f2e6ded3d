"""Does an export leave without names, noted in the library it comes from, whole or not at all?"""

import io
import json
import zipfile
from pathlib import Path
from uuid import uuid4

import pytest

from app.exports import exports
from app.exports.exports import Format, export_from_folder, export_from_library
from app.storage.audit import about
from app.storage.exchange import import_session
from app.storage.journal.disk import Room
from app.storage.keys import KeySlots
from app.storage.library import Library
from app.storage.opened import KEYS, OpenedLibrary
from app.storage.slots import Cost
from app.storage.stored import Action, LibraryError, Operator, Role
from core.results import Analysis
from core.samples import Session
from devices.files.refusal import FileRefusedError

NAME = "Miller"


def silent(share: float, what: str) -> None:
    """Tell nobody."""


def everything_in(folder: Path) -> str:
    """Every file's path and content, that of a workbook unpacked."""
    said = []
    for file in sorted(path for path in folder.rglob("*") if path.is_file()):
        content = file.read_bytes()
        if content.startswith(b"PK"):
            archive = zipfile.ZipFile(io.BytesIO(content))
            content = b"".join(archive.read(name) for name in archive.namelist())
        said.append(f"{file.relative_to(folder)}{content.decode('utf-8', 'replace')}")
    return "".join(said)


def files_in(folder: Path) -> list[str]:
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())


@pytest.fixture
def opened(tmp_path: Path) -> OpenedLibrary:
    folder = tmp_path / "library"
    folder.mkdir()
    key, _ = KeySlots(folder / KEYS, Cost(passes=1, memory_kib=64)).create("hk", "four short words here")
    return OpenedLibrary(Library.create(folder, key, Operator("hk", "H. Keller", Role.ADMINISTRATOR)), folder, key)


@pytest.mark.parametrize("wanted", Format)
def test_no_name_leaves_unless_identity_is_asked_for(
    visit: tuple[Session, Analysis], tmp_path: Path, wanted: Format
) -> None:
    for name in ("nameless", "again", "identified"):
        (tmp_path / name).mkdir()
        export_from_folder(*visit, [wanted], tmp_path / name, is_identified=name == "identified")
    said = everything_in(tmp_path / "nameless")
    assert NAME not in said
    assert "2026-11-21" not in said
    assert "SIMULATED" in said
    assert NAME in everything_in(tmp_path / "identified")


def test_a_session_of_no_library_gets_another_pseudonym_each_time(
    visit: tuple[Session, Analysis], tmp_path: Path
) -> None:
    codes = set()
    for name in ("one", "other"):
        (tmp_path / name).mkdir()
        export_from_folder(*visit, [Format.FHIR], tmp_path / name)
        bundle = json.loads((tmp_path / name / "fhir_bundle.json").read_text())
        codes.add(bundle["entry"][0]["resource"]["identifier"][0]["value"])
    assert len(codes) == 2


def test_a_library_notes_what_left_it_and_gives_the_same_pseudonym(
    visit: tuple[Session, Analysis], opened: OpenedLibrary, tmp_path: Path
) -> None:
    session, analysis = visit
    with opened:
        room = Room(start_bytes=0, kept_bytes=0)
        session_id = import_session(opened, session, silent, code=f"DEMO-{NAME}", room=room).session_id
        said = []
        for name in ("one", "other"):
            (tmp_path / name).mkdir()
            formats = [Format.FHIR, Format.MOT]
            export_from_library(opened, session_id, formats, tmp_path / name, {}, silent, analysed=lambda _: analysis)
            said.append(everything_in(tmp_path / name))
        assert said[0] == said[1]
        assert NAME not in said[0]
        noted = opened.library.audit.entries(about("session", session_id))
        told = [json.loads(entry.details) for entry in noted if entry.action == Action.EXPORT]
        assert [one["format"] for one in told] == ["fhir", "mot", "fhir", "mot"]
        assert not any(one["is_identified"] for one in told)
        with pytest.raises(LibraryError):
            export_from_library(opened, uuid4(), [Format.MOT], tmp_path, {}, silent)


def test_files_lie_as_those_of_the_analysis(visit: tuple[Session, Analysis], tmp_path: Path) -> None:
    export_from_folder(*visit, list(Format), tmp_path)
    assert files_in(tmp_path) == [
        "fhir_bundle.json",
        "free_motion/angles.c3d",
        "free_motion/angles.mot",
        "gaitwright.xlsx",
        "walk_1/angles.c3d",
        "walk_1/angles.mot",
    ]


def test_a_format_that_fails_leaves_nothing(
    visit: tuple[Session, Analysis], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.exports.c3d_angles.MOST_FRAMES", 100)
    with pytest.raises(FileRefusedError, match="more than a C3D can hold"):
        export_from_folder(*visit, [Format.XLSX, Format.C3D], tmp_path)
    assert files_in(tmp_path) == []


def test_a_missing_library_is_told_before_anything_is_done(
    visit: tuple[Session, Analysis], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(exports, "find_spec", lambda name: None)
    with pytest.raises(FileRefusedError, match="ezc3d"):
        export_from_folder(*visit, [Format.C3D], tmp_path)
    export_from_folder(*visit, [Format.FHIR], tmp_path)

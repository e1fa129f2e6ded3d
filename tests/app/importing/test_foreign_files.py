"""Tests that whatever the application reads of others goes through the limited process."""

import ast
import os
from pathlib import Path

import pytest

from app.cli.main import main
from app.importing import untrusted_files as foreign_files
from app.importing.untrusted_files import read_foreign_session, the_reader
from core.session import Session
from devices.files import child, limited_reader
from devices.files.limited_reader import ReadingEndedError
from devices.files.session_folder import read_session

ROOT = Path(__file__).parents[3]
READERS = {"read_session", "write_session", "read_site", "parse", "parse_toml", "read_csv", "read_parquet"}
OWN = {  # what they read was written by this program, a moment ago
    ("app/cli/demo.py", ""),
    ("app/importing/untrusted_files.py", ""),
}
TOML = 'format = "gaitwright-session/1"\n[[recordings]]\nname = "walk 1"\nkind = "walking"\nfolder = "walk_1"\n'
COLUMNS = "time_s,acc_x_m_s2,acc_y_m_s2,acc_z_m_s2,gyr_x_rad_s,gyr_y_rad_s,gyr_z_rad_s\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    folder = tmp_path / "session"
    (folder / "walk_1").mkdir(parents=True)
    (folder / "session.toml").write_text(TOML)
    (folder / "walk_1" / "left_thigh.csv").write_text(COLUMNS + "0,0,0,9.8,0,0,0\n0.01,0,0,9.8,0,0,0\n")
    return folder


def nothing() -> None: ...


def refusal(capsys: pytest.CaptureFixture[str]) -> str:
    (line,) = [line for line in capsys.readouterr().err.splitlines() if " % " not in line[:6]]
    return line


def readers_called(file: Path) -> list[tuple[str, str]]:
    """The functions of a file in which a reader of `devices.files` is imported, and the file."""
    text = file.read_text(encoding="utf-8")
    if "devices.files." not in text:
        return []
    tree = ast.parse(text)
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("devices.files."):
            names = {alias.name for alias in node.names}
            if names & READERS or "xsens" in (node.module or ""):
                within = [f.name for f in functions if f.lineno <= node.lineno <= (f.end_lineno or 0)]
                found.append((file.relative_to(ROOT).as_posix(), within[-1] if within else ""))
    return found


def test_nothing_of_the_application_reads_foreign_files_by_itself() -> None:
    found = {place for file in (ROOT / "app").rglob("*.py") for place in readers_called(file)}
    assert found == OWN


def test_a_session_is_read_by_another_process_and_is_the_same(folder: Path) -> None:
    session = read_foreign_session(folder, nothing)
    assert isinstance(session, Session)
    assert repr(session) == repr(read_session(folder))
    process = the_reader().process
    assert process is not None
    assert process.pid != os.getpid()


@pytest.mark.parametrize("command", ["analyse", "report", "compare", "export"])
def test_an_8_gb_file_is_refused_with_two(
    folder: Path, tmp_path: Path, command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with (folder / "walk_1" / "left_shank.csv").open("wb") as file:
        file.truncate(8_000_000_000)
    more = {"export": ["--as", "mot"]}.get(command, [])
    out = tmp_path / ("out.pdf" if command == "report" else "out")
    assert main([command, str(folder), "--out", str(out), *more]) == 2
    assert refusal(capsys) == (
        "walk_1/left_shank.csv: this file has 8000 MB, more than a recording should need. "
        "Choose a file of up to 1000 MB."
    )
    assert not out.exists()


def test_an_8_gb_file_is_not_imported(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with (tmp_path / "a.txt").open("wb") as file:
        file.truncate(8_000_000_000)
    where = ["--map", "left_thigh=a.txt", "--out", str(tmp_path / "session")]
    assert main(["import", str(tmp_path / "a.txt"), "--as", "xsens-mtmanager", *where]) == 2
    assert "a.txt: this file has 8000 MB, more than a recording should need." in refusal(capsys)
    assert not (tmp_path / "session").exists()


@pytest.mark.endurance
def test_a_file_that_takes_too_long_is_refused_with_two(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(limited_reader, "DEADLINE_S", 0.0)
    the_reader().close()  # to start again takes longer
    assert main(["analyse", str(folder), "--out", str(tmp_path / "out")]) == 2
    assert (
        "session.toml: reading the data takes longer than a recording should need. Export the recording again"
        in capsys.readouterr().err
    )
    monkeypatch.undo()
    read_foreign_session(folder, nothing)


def test_a_reader_that_fails_for_no_foreseen_reason_is_a_refusal_too(folder: Path) -> None:
    file = folder / "session.toml"
    task = {"task": "none that there is", "path": str(file)}
    with pytest.raises(ReadingEndedError, match="reading stopped early; the reason is in the log") as caught:
        the_reader().ask(task, [file], file.name, lambda details, _: details, nothing)
    assert caught.value.cause == child.UNFORESEEN
    assert foreign_files.the_reader().process is None

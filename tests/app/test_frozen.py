"""Tests that Gaitwright, frozen into a program of its own, begins its child processes again as itself."""

import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

from app import __main__ as opening
from devices.cameras import child as camera
from devices.files import child
from devices.files.limited_reader import LimitedReader, LimitedReading

ROOT = Path(__file__).parents[2]
PROGRAM = f"""#!{sys.executable}
import sys
sys.frozen = True
sys.path.insert(0, {str(ROOT)!r})
from app.__main__ import begin
sys.exit(begin())
"""


@pytest.fixture
def program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A stand-in for the frozen program, which takes no `-m`; this process is given that it is one."""
    file = tmp_path / "gaitwright"
    file.write_text(PROGRAM)
    file.chmod(0o755)
    monkeypatch.setattr(sys, "frozen", True, raising=False)
    monkeypatch.setattr(sys, "executable", str(file))
    monkeypatch.setenv("PYINSTALLER_RESET_ENVIRONMENT", "")  # what is set meanwhile is taken back
    return file


@pytest.mark.skipif(os.name == "nt", reason="a script stands in for the program")
@pytest.mark.usefixtures("program")
def test_foreign_files_are_read_by_the_program_itself(tmp_path: Path) -> None:
    (tmp_path / "session.toml").write_text('patient = "P-1"\n')
    reader = LimitedReader()
    try:
        reading = LimitedReading(reader, lambda: None)
        assert reading.read_toml(tmp_path / "session.toml") == {"patient": "P-1"}
        assert reader.process is not None
        assert reader.process.args[:2] == [sys.executable, child.WORD]  # type: ignore[index]  # a list, as it was given
    finally:
        reader.close()


@pytest.mark.parametrize("process", [child, camera])
def test_who_is_started_as_a_child_never_comes_to_the_command_line(
    process: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    done: list[str] = []
    monkeypatch.setenv("PYINSTALLER_RESET_ENVIRONMENT", "")
    monkeypatch.setattr(sys, "frozen", True, raising=False)
    monkeypatch.setattr(sys, "argv", ["gaitwright", process.WORD, "1000"])
    monkeypatch.setattr(process, "main", lambda: done.append("read"))
    monkeypatch.setattr(opening, "freeze_support", lambda: done.append("worker?"))
    with pytest.raises(SystemExit) as ended:
        opening.begin()
    assert ended.value.code is None
    assert done == ["worker?", "read"]


@pytest.mark.parametrize("is_frozen", [True, False])
def test_any_other_word_is_a_command(is_frozen: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYINSTALLER_RESET_ENVIRONMENT", "")
    monkeypatch.setattr(sys, "frozen", is_frozen, raising=False)
    monkeypatch.setattr(sys, "argv", ["gaitwright", "demo"])
    monkeypatch.setattr(child, "main", lambda: pytest.fail("it is no child"))
    monkeypatch.setattr("app.cli.main.main", lambda: 7)
    assert opening.begin() == 7


@pytest.mark.parametrize("before", [None, "/opt/theirs"])
def test_other_programs_get_the_systems_libraries_and_ours_begin_again(
    before: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "frozen", True, raising=False)
    monkeypatch.setattr(sys, "argv", ["gaitwright", "demo"])
    monkeypatch.setattr("app.cli.main.main", lambda: 0)
    monkeypatch.setenv("LD_LIBRARY_PATH", "/opt/gaitwright/_internal")
    monkeypatch.setenv("PYINSTALLER_RESET_ENVIRONMENT", "")
    if before:
        monkeypatch.setenv("LD_LIBRARY_PATH_ORIG", before)
    opening.begin()
    assert os.environ.get("LD_LIBRARY_PATH") == before
    assert "LD_LIBRARY_PATH_ORIG" not in os.environ
    assert os.environ["PYINSTALLER_RESET_ENVIRONMENT"] == "1"


def test_the_word_is_no_subcommand_and_no_option() -> None:
    from app.cli.parser import SUBCOMMANDS

    assert child.WORD not in SUBCOMMANDS
    assert not child.WORD.startswith("-")


CONFINED = """
import sys
from pathlib import Path
from devices.files.limits import forbid_reading
program, other = map(Path, sys.argv[1:])
sys.executable = str(program)
forbid_reading([])
program.read_bytes()
try:
    other.read_bytes()
except PermissionError:
    print("confined")
"""


@pytest.mark.skipif(sys.platform != "linux", reason="what a process reads is confined on Linux alone")
def test_a_confined_reading_still_imports_from_the_program(tmp_path: Path) -> None:
    """A bundle's modules are in its executable, and the first table imports some of them."""
    program, other = tmp_path / "bundle" / "gaitwright", tmp_path / "other.csv"
    program.parent.mkdir()
    for file in (program, other):
        file.write_text("modules")
    words = [sys.executable, "-c", CONFINED, str(program), str(other)]
    ended = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    assert ended.stdout in ("confined\n", "")  # a kernel without Landlock confines nothing

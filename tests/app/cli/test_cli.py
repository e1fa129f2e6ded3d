"""Tests of the command line: exit codes, one-line refusals, whole results or none, nothing destroyed."""

import csv
import importlib.metadata
import io
import json
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from syrupy.assertion import SnapshotAssertion

from app.cli import arguments
from app.cli import main as cli
from app.cli.main import main
from app.exports import result_folder
from app.exports.exports import Format
from app.exports.opensim_motion import Model
from app.reports.agreement.folder import REPORT
from app.storage.pseudonyms import Typed
from app.summary import request
from app.wording.findings import SENTENCES
from core.body import Site
from core.published.angles import DEFAULT_TAU_S
from core.results import Method
from core.samples import ImuBlock
from core.session import Recording, RecordingKind, Session
from devices.files.formats import FORMATS
from devices.files.session_folder import read_session, write_session

ROOT = Path(__file__).parents[3]

TABLES = ("angles.csv", "cycles.csv", "events.csv", "fitting.csv", "strides.csv")


def swinging(seconds: float, seed: int) -> dict[Site, ImuBlock]:
    """Make a thigh and a shank that swing about one axis of both sensors, with some noise."""
    rng = np.random.default_rng(seed)
    time_s = np.arange(round(100 * seconds)) / 100
    rates = {Site.LEFT_THIGH: np.sin(3 * time_s), Site.LEFT_SHANK: 3 * np.sin(4 * time_s + 1)}
    blocks = {}
    for site, rate in rates.items():
        tilt = np.cumsum(rate) / 100
        gyr_rad_s = rng.normal(scale=0.05, size=(len(time_s), 3))
        gyr_rad_s[:, 1] += rate
        acc_m_s2 = 9.81 * np.stack([-np.sin(tilt), 0 * tilt, np.cos(tilt)], axis=1)
        blocks[site] = ImuBlock(str(site), time_s, gyr_rad_s, acc_m_s2 + rng.normal(scale=0.1, size=acc_m_s2.shape))
    return blocks


@pytest.fixture(scope="module")
def pristine(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("visit") / "session"
    recordings = (
        Recording("free motion", RecordingKind.FREE_MOTION, "free_motion", swinging(6, 1)),
        Recording("walk 1", RecordingKind.WALKING, "walk_1", swinging(6, 2)),
    )
    write_session(Session(recordings), folder)
    return folder


@pytest.fixture
def session(pristine: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(pristine, tmp_path / "session"))


@pytest.fixture(scope="module")
def analysed(pristine: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The results of that session, with everything that there is."""
    folder = tmp_path_factory.mktemp("results") / "out"
    assert analyse(pristine, folder) == 0
    return folder


@pytest.fixture
def out(analysed: Path, tmp_path: Path) -> Path:
    """These results beside the session, which a test may write over."""
    return Path(shutil.copytree(analysed, tmp_path / "out"))


def files_in(folder: Path) -> dict[str, bytes]:
    """Give every file's bytes; of the report only its kind, as it alone holds the time of writing."""
    files = {str(f.relative_to(folder)): f.read_bytes() for f in sorted(folder.rglob("*")) if f.is_file()}
    return {name: content[:5] if name == "report.pdf" else content for name, content in files.items()}


def analyse(session: Path, out: Path, *more: str) -> int:
    return main(["analyse", str(session), "--out", str(out), *more])


def refusal(capsys: pytest.CaptureFixture[str]) -> str:
    """Give the last line on stderr, which must be the only one that is no progress."""
    lines = [line for line in capsys.readouterr().err.splitlines() if " % " not in line[:6]]
    assert len(lines) == 1
    return lines[0]


Refuses = Callable[..., str]


@pytest.fixture
def refuses(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Refuses:
    """What is stated of arguments that are refused, in the folder with the session."""
    monkeypatch.chdir(tmp_path)

    def refused(*arguments: str) -> str:
        assert main(arguments) == 2
        return refusal(capsys).replace(f"{tmp_path}{os.sep}", "").replace("\\", "/")

    return refused


def test_a_session_becomes_results_in_the_folders_of_its_recordings(analysed: Path) -> None:
    assert list(files_in(analysed)) == [
        "columns.csv",
        "csv-metadata.json",
        "fitting_means.csv",
        *(f"free_motion/{table}" for table in TABLES),
        "peaks.csv",
        "report.pdf",
        "results.xlsx",
        "session.rrd",
        "summary.json",
        *(f"walk_1/{table}" for table in TABLES),
    ]
    summary = json.loads((analysed / "summary.json").read_bytes())
    assert summary["format"] == "gaitwright-analysis/1"
    assert list(summary["joints"]) == ["left_knee"]
    header = (analysed / "walk_1" / "angles.csv").read_text().splitlines()[0]
    assert header.startswith("time_s,left_knee_deg,left_knee_sd_deg,left_knee_published_deg,left_knee_orientation_deg")


def test_two_runs_write_the_same_bytes_and_hold_no_path(session: Path, analysed: Path, tmp_path: Path) -> None:
    assert analyse(session, tmp_path / "second") == 0
    second = files_in(tmp_path / "second")
    assert files_in(analysed) == second
    assert not any(str(tmp_path).encode() in content for content in second.values())


def test_the_log_and_the_method_can_be_chosen(session: Path, tmp_path: Path) -> None:
    assert analyse(session, tmp_path / "out", "--no-rrd", "--no-report", "--method", "published", "--tau", "1.5") == 0
    assert "session.rrd" not in files_in(tmp_path / "out")
    summary = json.loads((tmp_path / "out" / "summary.json").read_bytes())
    assert summary["joints"]["left_knee"]["method"] == "published"


def test_progress_goes_to_stderr_and_the_result_to_stdout(
    session: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert analyse(session, tmp_path / "out", "--no-rrd", "--no-report") == 0
    stated = capsys.readouterr()
    percents = [int(line.split(" % ")[0]) for line in stated.err.splitlines()]
    assert percents[0] == 0
    assert percents[-1] == 100
    assert percents == sorted(percents)
    assert stated.out.startswith(f"{tmp_path / 'out'}: left knee; 2 recordings.\n")


def test_a_session_without_any_joint_is_done_all_the_same(session: Path, tmp_path: Path) -> None:
    for file in session.rglob("left_shank.csv"):
        file.unlink()
    assert analyse(session, tmp_path / "out") == 0
    findings = json.loads((tmp_path / "out" / "summary.json").read_bytes())["findings"]
    assert "grave" in {finding["severity"] for finding in findings}


def test_a_file_cut_mid_line_is_refused_in_one_line(
    session: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = session / "walk_1" / "left_shank.csv"
    file.write_bytes(file.read_bytes()[:-40])
    assert analyse(session, tmp_path / "out") == 2
    assert refusal(capsys).startswith("walk_1/left_shank.csv, line 601")
    assert not (tmp_path / "out").exists()


def test_a_missing_session_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert analyse(tmp_path / "nowhere", tmp_path / "out") == 2
    assert "nowhere: this folder is not a session folder" in refusal(capsys)


@pytest.mark.parametrize(
    "arguments",
    [
        ["analyse", "session"],
        ["analyse", "session", "--out", "o", "--method", "best"],
        ["analyse", "session", "--out", "o", "--tau", "-1"],
        ["analyse", "session", "--out", "o", "--tau", "soon"],
        ["import", "a.txt", "--as", "other", "--map", "left_thigh=a.txt", "--out", "o"],
        ["import", "a.txt", "--as", "xsens-mtmanager", "--map", "left_thigh=a.txt", "--kind", "running", "--out", "o"],
        ["analyze"],
        ["--fast"],
    ],
)
def test_bad_usage_is_refused_in_one_line(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stop:
        main(arguments)
    assert stop.value.code == 2
    assert "--help." in refusal(capsys)


@pytest.mark.parametrize("arguments", [[], ["analyse"], ["demo"], ["import"]])
def test_every_subcommand_has_help(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stop:
        main([*arguments, "--help"])
    assert stop.value.code == 0
    assert "usage: gaitwright" in capsys.readouterr().out


def test_help_comes_without_the_heavy_libraries() -> None:
    heavy = ("numpy", "scipy", "rerun", "pyarrow", "PySide6")
    program = (
        "import sys\nfrom app.cli.main import main\ntry: main(['--help'])\nexcept SystemExit: pass\n"
        f"sys.exit(any(name in sys.modules for name in {heavy}))"
    )
    assert subprocess.run([sys.executable, "-c", program], cwd=ROOT, check=False, capture_output=True).returncode == 0


def test_the_choices_are_those_of_the_core() -> None:
    assert tuple(Method) == arguments.METHODS
    assert tuple(RecordingKind) == arguments.KINDS
    assert tuple(FORMATS) == arguments.IMPORTED
    assert arguments.PAPERS == request.PAPERS
    assert arguments.DEFAULT_TAU_S == DEFAULT_TAU_S
    assert tuple(Format) == arguments.EXPORTED
    assert tuple(Model) == arguments.MODELS
    assert tuple(Typed) == arguments.TYPED
    assert arguments.AGREEMENT == REPORT


def test_without_a_screen_the_window_states_so(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "platform", "linux")
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM"):
        monkeypatch.delenv(name, raising=False)
    assert main([]) == 2
    assert "There is no screen here. See gaitwright --help for what works without one." in refusal(capsys)


def test_on_a_terminal_progress_is_one_line_that_renews_itself(
    session: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    assert analyse(session, tmp_path / "out", "--no-rrd", "--no-report") == 0
    stated = terminal.getvalue()
    assert "\n" not in stated
    assert "\r\x1b[K100 % writing" in stated
    assert stated.endswith("\r\x1b[K")  # the line is cleared at the end


def test_what_files_say_cannot_steer_the_terminal(
    session: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    about = (session / "session.toml").read_text().replace('name = "walk 1"', 'name = "walk \\u001b[2J"')
    (session / "session.toml").write_text(about)
    header = (session / "walk_1" / "left_thigh.csv").read_text().splitlines()[0]
    (session / "walk_1" / "left_thigh.csv").write_text(header + "\n")  # a finding that names the recording
    analyse(session, tmp_path / "out", "--no-rrd")
    stated = capsys.readouterr()
    assert "[2J" in stated.out + stated.err
    assert "\x1b" not in stated.out + stated.err


# The demonstration


@pytest.mark.endurance
def test_a_demonstration_is_a_session_with_its_truth_and_the_analysis_of_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["demo"]) == 0
    out = tmp_path / "gaitwright-demo"
    files = files_in(out)
    summary = json.loads(files["summary.json"])
    assert summary["simulated"] is True
    assert len(summary["joints"]) == 4
    assert [finding["key"] for finding in summary["findings"] if finding["key"] not in SENTENCES] == []
    assert analyse(out / "session", tmp_path / "again") == 0
    assert files_in(tmp_path / "again") == {name: c for name, c in files.items() if not name.startswith("session/")}

    with (out / "session" / "truth.csv").open(newline="") as file:
        truth = [row for row in csv.DictReader(file) if row["recording"] == "walk 1" and row["left_knee_deg"]]
    with (out / "walk_1" / "angles.csv").open(newline="") as file:
        angles = list(csv.DictReader(file))
    found_deg = np.interp(
        [float(row["time_s"]) for row in truth],
        [float(row["time_s"]) for row in angles if row["left_knee_deg"]],
        [float(row["left_knee_deg"]) for row in angles if row["left_knee_deg"]],
    )
    assert np.std(found_deg - [float(row["left_knee_deg"]) for row in truth]) < 2.0  # soft tissue

    assert main(["demo"]) == 0
    assert files_in(out) == files


# What is at OUT


def test_an_analysis_is_replaced_and_nothing_of_it_stays(session: Path, out: Path, tmp_path: Path) -> None:
    (out / "walk_9").mkdir()
    assert analyse(session, out, "--no-rrd", "--no-report") == 0
    assert list(files_in(out)) == [
        "columns.csv",
        "csv-metadata.json",
        "fitting_means.csv",
        *(f"free_motion/{table}" for table in TABLES),
        "peaks.csv",
        "summary.json",
        *(f"walk_1/{table}" for table in TABLES),
    ]
    assert not (out / "walk_9").exists()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out", "session"]


def test_an_empty_folder_is_filled(session: Path, tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    assert analyse(session, tmp_path / "out", "--no-rrd", "--no-report") == 0
    assert (tmp_path / "out" / "summary.json").is_file()


def test_a_folder_that_is_no_analysis_is_left_alone(
    refuses: Refuses, session: Path, tmp_path: Path, snapshot: SnapshotAssertion
) -> None:
    (tmp_path / "file").write_text("mine")
    for name, content in (("empty", ""), ("other", "{}"), ("visit", '{"format": "gaitwright-session/1"}')):
        (tmp_path / name).mkdir()
        (tmp_path / name / "summary.json").write_text(content)
    before = files_in(tmp_path)
    assert {
        case: refuses("analyse", "session", "--out", out)
        for case, out in {
            "a file": "file",
            "a summary without content": "empty",
            "a summary that states nothing": "other",
            "a summary of a session": "visit",
            "the session": "session",
            "a recording of the session": "session/walk_1",
            "a new folder in the session": "session/results",
        }.items()
    } == snapshot
    assert files_in(tmp_path) == before


def test_a_place_that_cannot_be_written_is_refused(
    session: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("mine")
    assert analyse(session, tmp_path / "file" / "out") == 2
    assert "cannot be written" in refusal(capsys)


def test_a_full_disk_leaves_the_old_results(
    session: Path, out: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    before = files_in(out)

    def no_room(*_: object) -> None:
        raise OSError(28, "No space left on device", str(tmp_path / ".out-1234" / "summary.json"))

    monkeypatch.setattr(result_folder, "write_summary", no_room)
    assert analyse(session, out, "--no-rrd") == 2
    assert refusal(capsys).startswith(f"{out}: this cannot be written (No space left on device).")
    assert files_in(out) == before
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out", "session"]


def test_the_session_of_a_demonstration_stays_among_its_results(session: Path, out: Path, tmp_path: Path) -> None:
    inside = Path(shutil.move(session, out / "session"))
    before = files_in(inside)
    assert analyse(inside, out, "--no-rrd") == 0
    assert files_in(inside) == before
    assert not (out / "session.rrd").exists()
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_recordings_anywhere_else_in_out_are_never_replaced(
    refuses: Refuses, session: Path, out: Path, snapshot: SnapshotAssertion
) -> None:
    def analysing(folder: str) -> str:
        return refuses("analyse", folder, "--out", "out")

    other = Path(shutil.copytree(session, out / "visits" / "other"))
    found = {"anywhere in it": analysing("session"), "analysed themselves": analysing("out/visits/other")}
    assert files_in(other) == files_in(session)
    shutil.move(other, out / "session")
    found |= {
        "the session of someone else": analysing("session"),
        "for a demonstration": refuses("demo", "--out", "out"),
    }
    summary = json.loads((out / "summary.json").read_bytes())
    (out / "summary.json").write_text(json.dumps(summary | {"simulated": True}))
    found["a real session among simulated results"] = refuses("demo", "--out", "out")
    assert found == snapshot
    assert files_in(out / "session") == files_in(session)


def test_a_recording_named_like_a_result_is_refused(
    session: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    about = (session / "session.toml").read_text().replace('folder = "walk_1"', 'folder = "summary.json"')
    (session / "session.toml").write_text(about)
    (session / "walk_1").rename(session / "summary.json")
    assert analyse(session, tmp_path / "out") == 2
    assert "has the name of one of the results" in refusal(capsys)
    assert not (tmp_path / "out").exists()


# Interruption


def test_an_interruption_leaves_the_old_results(
    session: Path, out: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    before = files_in(out)

    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(result_folder, "write_angles", interrupted)
    assert analyse(session, out) == 3
    assert refusal(capsys).startswith("Stopped.")
    assert files_in(out) == before
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out", "session"]


def test_an_interruption_between_the_renames_puts_everything_back(
    session: Path, out: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    inside = Path(shutil.move(session, out / "session"))
    before = files_in(out)
    rename = Path.rename

    def stumbles(self: Path, target: Path) -> Path:
        if self.name == "new":
            raise KeyboardInterrupt
        return rename(self, target)

    monkeypatch.setattr(Path, "rename", stumbles)
    assert analyse(inside, out, "--no-rrd") == 3
    assert files_in(out) == before
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


@pytest.mark.endurance
@pytest.mark.skipif(os.name == "nt", reason="signals of this kind are not for Windows")
def test_a_signal_in_the_middle_ends_with_three(session: Path, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "app", "analyse", str(session), "--out", str(tmp_path / "out")]
    with subprocess.Popen(command, cwd=ROOT, stderr=subprocess.PIPE, text=True) as run:
        assert run.stderr is not None
        run.stderr.readline()  # the first progress: it has begun
        run.send_signal(signal.SIGINT)
        assert run.wait(timeout=60) == 3
        assert "Traceback" not in run.stderr.read()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["session"]


INTERRUPTED_IN_A_LIBRARY = """
import os, signal, sys
from app.cli import main as cli
def run(wanted):
    exec("os.kill(os.getpid(), signal.SIGINT)", {"os": os, "signal": signal})
cli._run = run
sys.exit(cli.main(["analyse", "session", "--out", "out"]))
"""


@pytest.mark.skipif(os.name == "nt", reason="signals of this kind are not for Windows")
def test_a_signal_that_falls_into_the_exec_of_a_library_ends_with_three_too(tmp_path: Path) -> None:
    (tmp_path / "interrupted.py").write_text(INTERRUPTED_IN_A_LIBRARY)
    command = [sys.executable, "-m", "interrupted"]  # only so does the interpreter remember the signal
    paths = {**os.environ, "PYTHONPATH": str(tmp_path)}
    ended = subprocess.run(command, cwd=ROOT, env=paths, capture_output=True, text=True, check=False)
    assert ended.stderr.splitlines() == ["Stopped. out is as it was before."]
    assert ended.returncode == 3


# Import


def mt_file(folder: Path, sensor: str, seed: int) -> Path:
    rng = np.random.default_rng(seed)
    rows = [
        "\t".join([str(1000 + i), *(f"{value:.5f}" for value in rng.normal(loc=(0, 0, 9.8, 0, 0, 0)))])
        for i in range(400)
    ]
    names = ["PacketCounter", "Acc_X", "Acc_Y", "Acc_Z", "Gyr_X", "Gyr_Y", "Gyr_Z"]
    path = folder / f"MT_01-000_{sensor}.txt"
    path.write_text("// Update Rate: 100.0Hz\n" + "\n".join(["\t".join(names), *rows]) + "\n")
    return path


def imported(folder: Path, out: Path, *more: str) -> int:
    files = [mt_file(folder, sensor, seed) for seed, sensor in enumerate(("00B42D4B", "00B42D4E", "00B42D4F"))]
    where = "left_thigh=00B42D4B,left_shank=MT_01-000_00B42D4E.txt"
    arguments = ["import", *map(str, files), "--as", "xsens-mtmanager", "--map", where, "--out", str(out), *more]
    return main(arguments)


def test_an_import_makes_a_session_and_a_second_one_adds_to_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "session"
    assert imported(tmp_path, out) == 0
    assert "MT_01-000_00B42D4F.txt" in capsys.readouterr().out
    first = files_in(out)
    assert imported(tmp_path, out, "--kind", "free_motion", "--recording", "circling") == 0
    second = files_in(out)
    folders = {name.split("/")[0] for name in second}
    assert folders == {"session.toml", "walk_1", "circling"}
    assert len(second) == 5
    assert second["walk_1/left_thigh.csv"] == first["walk_1/left_thigh.csv"]
    assert analyse(out, tmp_path / "out", "--no-rrd", "--no-report") == 0


def test_a_mapping_file_places_sensors_and_they_may_have_shared_a_receiver(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], test_data: Callable[[str], Path]
) -> None:
    folder, out = test_data("vendor_exports/xsens_mtmanager"), tmp_path / "session"
    files = map(str, sorted(folder.glob("OpenSenseExample_MT*.txt")))
    mapping = str(folder / "OpenSenseExample_myIMUMappings.xml")
    assert main(["import", *files, "--map", mapping, "--one-receiver", "--out", str(out)]) == 0
    assert f"{out} now holds walk 1, with 7 of 7 sites." in capsys.readouterr().out
    session = read_session(out)
    assert session.sensors[Site.LEFT_THIGH].serial == "00B421EE"
    assert {info.clock for info in session.sensors.values()} == {"one receiver"}
    assert imported(tmp_path, tmp_path / "other", "--one-receiver") == 0
    assert "with 2 of 6 sites." in capsys.readouterr().out


def test_an_import_shows_the_program_by_the_content(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mt = mt_file(tmp_path, "00B42D4B", 0).rename(tmp_path / "opal.csv")
    apdm = tmp_path / "MT_01-000_00B42D4B.txt"
    heads = ["Format=7,17,,,Left Thigh,,", "Time,Accelerometer,,,Gyroscope,,", ",X,Y,Z,X,Y,Z"]
    apdm.write_text("\n".join([*heads, *(f"{1_000_000 + 10_000 * k},0,0,9.81,0.1,0,0" for k in range(400)), ""]))
    where = ["--map", "left_thigh=17", "--out", str(tmp_path / "session")]
    assert main(["import", str(apdm), *where]) == 0
    assert main(["import", str(mt), "--map", "left_thigh=opal.csv", "--out", str(tmp_path / "other")]) == 0
    capsys.readouterr()
    assert main(["import", str(mt), "--as", "apdm", "--map", "left_thigh=A", "--out", str(tmp_path / "third")]) == 2
    assert "opal.csv: the file is not an export from APDM software" in refusal(capsys)
    strange = tmp_path / "taxes.csv"
    strange.write_text("year,amount\n2026,1\n")
    assert main(["import", str(strange), *where]) == 2
    assert "taxes.csv: the file format is not recognised, and the file is not a table of numbers" in refusal(capsys)
    assert len(files_in(tmp_path / "session")) == 2


def test_an_import_of_the_same_name_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert imported(tmp_path, tmp_path / "session", "--recording", "walk A") == 0
    before = files_in(tmp_path / "session")
    capsys.readouterr()
    assert imported(tmp_path, tmp_path / "session", "--recording", "walk A") == 2
    assert refusal(capsys).startswith("walk A: ")
    assert files_in(tmp_path / "session") == before


def test_an_import_into_something_else_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "taxes").mkdir()
    (tmp_path / "taxes" / "2026.txt").write_text("mine")
    assert imported(tmp_path, tmp_path / "taxes") == 2
    assert "not a session folder" in refusal(capsys)
    assert files_in(tmp_path / "taxes") == {"2026.txt": b"mine"}


def test_a_map_that_names_no_file_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = mt_file(tmp_path, "00B42D4B", 0)
    arguments = ["import", str(file), "--as", "xsens-mtmanager", "--out", str(tmp_path / "session")]
    for text in ("left_thigh=00FFFFFF", "left_hand=00B42D4B", "left_thigh"):
        assert main([*arguments, "--map", text]) == 2
        assert "--map" in refusal(capsys)
    assert not (tmp_path / "session").exists()


def test_it_states_its_version(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="0"):
        cli.main(["--version"])
    assert capsys.readouterr().out.strip() == f"gaitwright {importlib.metadata.version('gaitwright')}"


def test_an_unknown_subcommand_is_named_with_those_there_are(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="2"):
        cli.main(["nonsense"])
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("gaitwright: invalid choice: 'nonsense' (choose from ")


def test_a_language_is_taken_before_anything_else(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    opened: list[tuple[list[str], str]] = []

    def note(arguments: list[str], language: str) -> int:
        opened.append((arguments, language))
        return 0

    monkeypatch.setattr(cli, "_open_window", note)
    assert cli.main(["--lang", "de"]) == 0
    assert opened == [([], "de")]
    with pytest.raises(SystemExit, match="2"):
        cli.main(["--lang", "fr"])
    assert "invalid choice: 'fr'" in capsys.readouterr().err


def test_a_session_folder_alone_opens_the_window(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    opened: list[list[str]] = []

    def note(arguments: list[str], language: str) -> int:
        assert not language
        opened.append(arguments)
        return 0

    monkeypatch.setattr(cli, "_open_window", note)
    assert cli.main([str(tmp_path)]) == 0
    assert opened == [[str(tmp_path)]]
    (tmp_path / "demo").mkdir()
    monkeypatch.chdir(tmp_path)
    assert not cli._is_folder("demo")

"""`batch` writes what `analyse` writes, does nothing twice, keeps what is done, and gives what failed."""

import json
import shutil
import sys
from pathlib import Path
from typing import Any

import pytest

from app.cli.main import main
from app.cohort.batch import done, run, task
from app.cohort.batch.analysed_folder import AnalysisChoices, write_analysed
from app.cohort.batch.done import batch_at, read_mark
from app.cohort.batch.software import software
from core.results import Method
from core.session import Patient
from core.verdicts.sigmas import PUBLISHED, ErrorFigures, in_use
from devices.files.session_folder import write_session
from tests.app.batch_material import results_in, swinging_session, walked_session, write_swinging
from tests.app.cohort.repeatability.own_study import own_study
from tests.app.exports.written_tables import csv_rows

BARE = ("--no-report", "--no-rrd", "--workers", "1")
CHOICES = AnalysisChoices(Method.ROBUST, 2.0, has_report=False, has_log=False)


@pytest.fixture(scope="module")
def pristine(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three sessions, of which one cannot be read, and what the batch made of them."""
    place = tmp_path_factory.mktemp("batch")
    write_swinging(place / "in" / "deep", 2)
    (place / "in" / "broken").mkdir()
    (place / "in" / "broken" / "session.toml").write_text("format = ", encoding="utf-8")
    assert main(["batch", str(place / "in"), "--out", str(place / "out"), *BARE]) == 0
    return place


@pytest.fixture
def place(pristine: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(pristine, tmp_path / "batch"))


@pytest.fixture
def analysed(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The notes of the sessions that are analysed from now on."""
    noted: list[str] = []
    whole = write_analysed

    def noting(session: object, *rest: object) -> object:
        noted.append(session.patient.code)  # type: ignore[attr-defined]  # a session, as the real one takes
        return whole(session, *rest)  # type: ignore[arg-type]  # as it was called

    monkeypatch.setattr(task, "write_analysed", noting)
    return noted


def again(place: Path, *more: str) -> int:
    return main(["batch", str(place / "in"), "--out", str(place / "out"), *BARE, *more])


def rows(place: Path, name: str = "parameters.csv") -> list[dict[str, str]]:
    return csv_rows(place / "out" / name)


def refusal(capsys: pytest.CaptureFixture[str]) -> str:
    (line,) = [line for line in capsys.readouterr().err.splitlines() if " % " not in line[:6]]
    return line


def test_the_results_of_a_session_are_those_of_analyse_to_the_byte(pristine: Path, tmp_path: Path) -> None:
    session, out = pristine / "in" / "deep" / "visit 001", tmp_path / "alone"
    assert main(["analyse", str(session), "--out", str(out), *BARE[:2]]) == 0
    assert results_in(pristine / "out" / "visit 001") == results_in(out)
    assert sorted(path.name for path in (pristine / "out").iterdir()) == [
        *(".gaitwright-batch", "failures.csv", "parameters.csv", "parameters.parquet", "visit 000", "visit 001"),
    ]


def test_what_failed_is_listed_with_its_reason_and_the_rest_is_done(
    place: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (failed,) = rows(place, "failures.csv")
    assert failed["session"] == "broken"
    assert failed["reason"].startswith("session.toml: the file is not TOML")
    assert {row["session"] for row in rows(place)} == {"visit 000", "visit 001"}
    assert again(place) == 0
    first, reported = capsys.readouterr().out.splitlines()
    assert first.endswith(
        "3 sessions, 0 analysed, 2 were done before, 1 failed; 6 rows in parameters.csv and .parquet."
    )
    assert reported.startswith("- broken: session.toml: the file is not TOML")


def test_the_same_command_again_analyses_nothing_and_writes_the_same_table(place: Path, analysed: list[str]) -> None:
    before = results_in(place / "out")
    assert again(place) == 0
    assert analysed == []
    assert results_in(place / "out") == before


def test_only_a_session_that_changed_is_done_again(place: Path, analysed: list[str]) -> None:
    write_session(swinging_session(1, Patient(code="another")), place / "in" / "deep" / "visit 001")
    assert again(place) == 0
    assert analysed == ["another"]
    shutil.rmtree(place / "out" / "visit 000")
    assert again(place) == 0
    assert analysed == ["another", "MUSTER-0"]


def test_another_choice_or_another_software_does_all_of_it_again(
    place: Path, analysed: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert again(place, "--method", "published") == 0
    assert analysed == ["MUSTER-0", "MUSTER-1"]
    for module in (run, task):
        monkeypatch.setattr(module, "software", lambda: "the next one")
    assert again(place, "--method", "published") == 0
    assert analysed == 2 * ["MUSTER-0", "MUSTER-1"]


def test_a_session_that_can_no_longer_be_read_leaves_the_table_and_comes_back(place: Path, analysed: list[str]) -> None:
    file = place / "in" / "deep" / "visit 000" / "walk_1" / "left_shank.csv"
    whole = file.read_bytes()
    file.write_bytes(whole[:-40])
    assert again(place) == 0
    assert {row["session"] for row in rows(place)} == {"visit 001"}
    assert [row["session"] for row in rows(place, "failures.csv")] == ["broken", "visit 000"]
    file.write_bytes(whole)
    assert again(place) == 0
    assert {row["session"] for row in rows(place)} == {"visit 000", "visit 001"}
    assert analysed == ["MUSTER-0"]


def test_an_interrupted_batch_keeps_what_is_done_and_goes_on_there(
    pristine: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copytree(pristine / "in", tmp_path / "in")
    whole = write_analysed
    done_before: list[int] = []

    def interrupted(*arguments: object) -> object:
        if done_before:
            raise KeyboardInterrupt
        done_before.append(1)
        return whole(*arguments)  # type: ignore[arg-type]  # as it was called

    with monkeypatch.context() as patched:
        patched.setattr(task, "write_analysed", interrupted)
        assert again(tmp_path) == 3
    assert "What is done stays in OUT" in refusal(capsys)
    assert {row["session"] for row in rows(tmp_path)} == {"visit 000"}
    assert not (tmp_path / "out" / "visit 001").exists()
    assert again(tmp_path) == 0
    assert "1 analysed, 1 were done before" in capsys.readouterr().out
    assert results_in(tmp_path / "out") == results_in(pristine / "out")


def test_results_whose_record_was_not_written_any_more_are_made_again(place: Path, analysed: list[str]) -> None:
    for record in (place / "out" / done.FOLDER / done.DONE).iterdir():
        record.write_bytes(record.read_bytes()[:100])  # as a disk may leave it that lost its power
    (place / "out" / done.FOLDER / "work").mkdir()
    (place / "out" / done.FOLDER / "work" / ".visit 000-killed").mkdir()
    before = results_in(place / "out")
    assert again(place) == 0
    assert analysed == ["MUSTER-0", "MUSTER-1"]
    assert results_in(place / "out") == before
    assert not (place / "out" / done.FOLDER / "work").exists()


def test_progress_shows_the_count_the_rate_and_the_end(place: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert again(place) == 0
    lines = capsys.readouterr().err.splitlines()
    assert lines[0] == "  0 % 0 of 3 sessions"
    assert lines[-1] == "100 % 3 of 3 sessions, 1 failed"
    assert " a minute, done at about " in lines[1]


def test_what_is_no_batch_is_not_written_into(place: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shutil.rmtree(place / "out" / done.FOLDER)
    before = results_in(place / "out")
    assert again(place) == 2
    assert refusal(capsys).endswith("this already exists and is not a batch analysis. Choose another --out.")
    assert results_in(place / "out") == before
    (place / "file").write_text("mine")
    assert main(["batch", str(place / "in"), "--out", str(place / "file"), *BARE]) == 2
    assert (place / "file").read_text() == "mine"


def test_a_folder_without_sessions_and_one_that_is_not_there_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "in").mkdir()
    assert again(tmp_path) == 2
    assert "there is no session folder in it" in refusal(capsys)
    assert not (tmp_path / "out").exists()
    assert main(["batch", str(tmp_path / "none"), "--out", str(tmp_path / "out"), *BARE]) == 2
    assert "this folder does not exist" in refusal(capsys)


def test_two_programs_do_not_work_at_one_batch(place: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with batch_at(place / "out"):
        assert again(place) == 2
    assert "another program is working at this batch" in refusal(capsys)


def test_without_dask_the_refusal_names_what_brings_it(
    place: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    monkeypatch.delitem(sys.modules, "app.cohort.batch.cluster", raising=False)
    assert main(["batch", str(place / "in"), "--out", str(place / "out"), "--dask", "tcp://127.0.0.1:1"]) == 2
    assert refusal(capsys).endswith("Install it with pip install .[cluster].")


@pytest.mark.parametrize("workers", ["0", "-1", "two", "1001", "²"])
def test_what_is_no_number_of_workers_is_refused_as_usage(workers: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["batch", "in", "--out", "out", "--workers", workers])
    assert ended.value.code == 2
    assert "is no number of workers" in capsys.readouterr().err


def test_a_worker_that_sees_other_folders_or_has_other_software_states_so(place: Path) -> None:
    session, out = place / "in" / "deep" / "visit 000", place / "out"
    here = done.BatchFolder(out, read_mark(out) or "")
    same_path = done.BatchFolder(out, "the mark of the asking computer's own folder")
    for batch, folder, theirs, reason in (
        (same_path, session, software(), "cannot access OUT. FOLDER and OUT have to be on a disk that all workers see"),
        (here, place / "elsewhere", software(), "the worker here cannot access the session folder"),
        (here, session, "older", "has another version of Gaitwright"),
    ):
        outcome = task.analyse_task(task.BatchTask("visit 000", folder, batch, CHOICES, theirs))
        assert reason in outcome.failure
        assert outcome.record is None


def test_a_worker_judges_by_the_figures_of_whoever_asks_and_other_figures_make_other_results(
    place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    judged: list[ErrorFigures] = []

    def noted(*args: Any) -> Any:
        judged.append(in_use())
        return write_analysed(*args)

    monkeypatch.setattr(task, "write_analysed", noted)
    session, made = place / "in" / "deep" / "visit 000", []
    with batch_at(place / "out") as folder:
        for figures in (PUBLISHED, own_study(1.5).figures, own_study(1.6).figures):
            outcome = task.analyse_task(task.BatchTask("one", session, folder, CHOICES, software(), figures=figures))
            assert outcome.record is not None
            made.append(outcome.record.key)
    assert [one.study is not None for one in judged] == [False, True, True]
    assert len(set(made)) == 3
    assert in_use() is PUBLISHED
    summary = json.loads((place / "out" / "one" / "summary.json").read_bytes())
    assert summary["error_figures"] == {"source": "own_study", "people": 20, "day": "2026-11-12"}


def test_a_fault_of_the_program_fails_its_session_alone_and_quotes_nobody(
    place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def faulty(*_: object) -> None:
        raise RuntimeError("of Anna Muster")

    monkeypatch.setattr(task, "write_analysed", faulty)
    assert again(place, "--method", "published") == 0
    reasons = {row["session"]: row["reason"] for row in rows(place, "failures.csv")}
    assert set(reasons) == {"broken", "visit 000", "visit 001"}
    assert "RuntimeError" in reasons["visit 000"]
    assert "Muster" not in reasons["visit 000"]


def test_no_room_ends_the_batch_in_one_line(
    place: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(task, "write_analysed", full)
    assert again(place, "--method", "published") == 2
    assert "this cannot be written (No space left on device)" in refusal(capsys)


@pytest.mark.endurance
def test_reports_and_logs_are_those_of_analyse_too(tmp_path: Path) -> None:
    write_session(walked_session(), tmp_path / "in" / "visit")
    assert main(["batch", str(tmp_path / "in"), "--out", str(tmp_path / "out"), "--workers", "2"]) == 0
    assert main(["analyse", str(tmp_path / "in" / "visit"), "--out", str(tmp_path / "alone")]) == 0
    found = results_in(tmp_path / "out" / "visit")
    assert found == results_in(tmp_path / "alone")
    assert {"report.pdf", "session.rrd", "walk_1/strides.csv"} <= set(found)

"""`gaitwright repeatability`: refused of too few people, and whole from session folders to the file."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import pytest

from app.cli.main import main
from core.verdicts.own_figures import figures_from_json
from devices.files.session_folder import write_session
from devices.simulation.walker import PEOPLE, FreeMotion, Standing, Tissue, Walk, WalkerSettings
from tests.app.batch_material import write_swinging
from tests.simulated import session_of


def last_line(capsys: pytest.CaptureFixture[str]) -> str:
    return capsys.readouterr().err.splitlines()[-1]


def test_too_few_people_are_refused_and_nothing_is_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_swinging(tmp_path / "in", 2)
    assert main(["repeatability", str(tmp_path / "in"), "--out", str(tmp_path / "out")]) == 2
    assert "0 of the 5 people needed were measured" in last_line(capsys)
    assert not (tmp_path / "out").exists()


def test_a_folder_of_something_else_is_not_replaced(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "letter.txt").write_text("to a friend", encoding="utf-8")
    assert main(["repeatability", str(tmp_path), "--out", str(tmp_path / "out")]) == 2
    assert "this already exists and is not a study" in last_line(capsys)


@pytest.mark.endurance
def test_five_simulated_people_attached_twice_give_figures_and_files(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    again = (
        *(Standing(), FreeMotion(duration_s=6.0), Walk(strides=12)),
        *(
            Standing("standing 2", is_restrapped_before=True),
            FreeMotion("free motion 2", 6.0),
            Walk("walk 2", strides=12),
        ),
    )
    for number in range(5):
        settings = WalkerSettings(seed=100 + number, tissue=Tissue.REAL, variation=PEOPLE, recordings=again)
        session = session_of(settings)
        of = replace(session.patient, code=f"H-{number}")
        write_session(replace(session, patient=of, started="2026-11-12T10:00:00"), tmp_path / "in" / f"H-{number}")
    assert main(["repeatability", str(tmp_path / "in"), "--out", str(tmp_path / "out")]) == 0
    printed = capsys.readouterr().out
    assert printed.startswith("SIMULATED. Own error figures, 5 people")
    assert "Preliminary: fewer than 10 people." in printed
    content = json.loads((tmp_path / "out" / "repeatability.json").read_bytes())
    own = figures_from_json(content)
    assert (own.people, own.is_simulated, own.is_preliminary) == (5, True, True)
    assert {"stance", "time", "length", "knee_shape", "ankle_shape"} <= set(content["sigmas"])
    with (tmp_path / "out" / "repeatability.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(content["sigmas"]) + len(content["between_legs"])
    for row in rows:
        assert float(row["low"]) <= float(row["own"]) <= float(row["high"])

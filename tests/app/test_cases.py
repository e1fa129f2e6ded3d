"""Small inputs that once gave a wrong number, a wrong sentence or a dead end, each with its right outcome.

Each is a folder of the shared recordings, whose README states how it is run and what is right.
"""

import json
import re
import shutil
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.cli import agree, import_files, places
from app.cli.main import main
from app.cohort.batch import analysed_folder
from core.body import Site
from core.samples import ImuBlock
from devices.files.formats import read_trial
from devices.files.references.reading import read_reference
from devices.files.session_folder import read_session, write_session
from devices.simulation.walker import FreeMotion, Standing, Walk, WalkerSettings
from tests.benchmarks.long import repeated
from tests.simulated import analysis_of, simulation_of

CASES = "cases"


@dataclass(frozen=True, slots=True)
class Outcome:
    """What the terminal was reported, and the exit code."""

    code: int
    text: str


class Case:
    """One folder's copy, as the working folder of the command line."""

    def __init__(self, out: Path, capsys: pytest.CaptureFixture[str]) -> None:
        self.out = out
        self._capsys = capsys

    def run(self, *arguments: str | Path) -> Outcome:
        code = main([str(argument) for argument in arguments])
        reported = self._capsys.readouterr()
        return Outcome(code, reported.out + reported.err)

    def import_two(
        self, *more: str, thigh: str = "lt.csv", shank: str = "ls.csv", files: tuple[str, ...] = ()
    ) -> Outcome:
        placed = f"left_thigh={thigh},left_shank={shank}"
        return self.run("import", *(files or (thigh, shank)), *more, "--map", placed, "--out", self.out)

    def blocks(self) -> Mapping[Site, ImuBlock]:
        return read_session(self.out).recordings[0].imu

    def reported(self) -> set[str]:
        return {one.key for one in read_session(self.out).findings}

    def analyse(self, session: str | Path) -> dict[str, Any]:
        """The summary of an analysis."""
        results = self.out.with_name("results")
        assert self.run("analyse", session, "--out", results, "--no-report", "--no-rrd").code == 0
        summary: dict[str, Any] = json.loads((results / "summary.json").read_text())
        return summary


def length_s(block: ImuBlock) -> float:
    return float(block.time_s[-1] - block.time_s[0])


def read_whole(case: Case, outcome: Outcome, seconds: float = 16.81) -> None:
    assert outcome.code == 0, outcome.text
    assert [round(length_s(block), 1) for block in case.blocks().values()] == [pytest.approx(seconds, abs=0.06)] * 2


def xdf(case: Case, thigh: str = "thigh", shank: str = "shank") -> Outcome:
    return case.import_two(thigh=thigh, shank=shank, files=("r.xdf",))


def xdf_stamps_step_back(case: Case) -> None:
    outcome = xdf(case)
    assert outcome.code == 2
    assert 'thigh, sample 801: "time" goes back from 7.99 to 7.5' in outcome.text
    assert not case.out.exists()
    placed = "left_thigh=thigh,left_shank=shank"
    assert case.run("import", "r.xdf", "--split-at", "8.0", "--map", placed, "--out", case.out).code == 0
    legs = [walk["left"] for walk in case.analyse(case.out)["walks"].values()]
    strides = np.array([leg["strides_used"] for leg in legs])
    times_s = np.array([leg["stride_time_s_mean"] for leg in legs])
    assert len(legs) == 2
    assert float(times_s @ strides / strides.sum()) == pytest.approx(1.080, abs=0.005)
    assert [leg["knee_range_deg_mean"] for leg in legs] == [pytest.approx(61.7, abs=1.0)] * 2


def xdf_block_jumps(case: Case) -> None:
    read_whole(case, outcome := xdf(case))
    assert "Some time stamps (100) are wrong, the first at sample 801, off by 200000 s" in outcome.text
    reported = [one for one in case.analyse(case.out)["findings"] if one["key"] == "stamps_mended"]
    assert [one["where"] for one in reported] == ["walk 1, left_shank"]


def xdf_no_clock_offsets(case: Case) -> None:
    read_whole(case, xdf(case))
    assert {one.clock for one in read_session(case.out).sensors.values()} == {"pc1", "pc2"}
    summary = case.analyse(case.out)
    assert "clock_not_measured" in {one["key"] for one in summary["findings"]}
    assert summary["joints"]["left_knee"]["lag_s"] == pytest.approx(0.0, abs=0.005)


def xdf_one_name_one_source(case: Case) -> None:
    read_whole(case, xdf(case, "imu 1", "imu 2"))


def ximu3_restarted(case: Case) -> None:
    outcome = case.import_two(thigh="lt", shank="ls")
    assert outcome.code == 2
    assert "line 902: Timestamp (us) goes back from 8990000 to 500000" in outcome.text
    assert "repeat" not in outcome.text
    assert case.import_two("--split-at", "9.0", thigh="lt", shank="ls").code == 0
    assert [len(one.imu[Site.LEFT_SHANK]) for one in read_session(case.out).recordings] == [900, 782]


def clock_jumps_forward(case: Case) -> None:
    outcome = case.import_two(thigh="lt", shank="ls")
    assert outcome.code == 2
    assert "ls: the sensor's clock jumps forward by 10800 s, 8.99 s after the start" in outcome.text
    assert "missing" not in outcome.text
    assert "receiver" not in outcome.text
    assert case.import_two("--split-at", "9.0", thigh="lt", shank="ls").code == 0
    assert "split_clocks" in case.reported()


def clipped_at_2g(case: Case) -> None:
    verdicts = case.analyse(".")["walks"]["walk 1"]["verdicts"]
    assert {verdicts[side]["distance"]["verdict"] for side in ("left", "right")} <= {"care", "withheld"}


def pause_in_a_walk(case: Case) -> None:
    walk = case.analyse(".")["walks"]["walk 1"]
    for side in ("left", "right"):
        assert walk["verdicts"][f"{side}_knee"]["shape"]["verdict"] in ("read", "care")
        assert walk["verdicts"][f"{side}_ankle"]["shape"]["verdict"] in ("read", "care")
        assert walk["verdicts"][side]["distance"]["verdict"] in ("read", "care")
        assert walk[side]["strides_used"] >= 25


def dot_every_second_lost(case: Case) -> None:
    assert case.import_two().code == 0
    assert re.search(r"every second|\b(49\.\d|50(\.\d)?) %", json.dumps(case.analyse(case.out), ensure_ascii=False))


def c3d_over_65535_frames(case: Case) -> None:
    simulated = simulation_of(
        WalkerSettings(seed=1, rate_hz=200.0, recordings=(Standing(), FreeMotion(), Walk(strides=10)))
    )
    standing, motion, walk = simulated.session.recordings
    long = replace(walk, imu={site: repeated(block, 330.0) for site, block in walk.imu.items()})
    session = case.out.with_name("session")
    write_session(replace(simulated.session, recordings=(standing, motion, long)), session)
    assert case.run("export", session, "--as", "c3d,mot,xlsx", "--out", case.out).code == 0
    assert {path.suffix for path in case.out.rglob("*")} >= {".mot", ".xlsx"}


def acc_and_gyro_apart(case: Case) -> None:
    files = tuple(f"{site}_{what}.csv" for site in ("lt", "ls") for what in ("Accelerometer", "Gyroscope"))
    outcome = case.import_two(thigh=files[0], shank=files[2], files=files)
    read_whole(case, outcome)
    assert "joined_files" in case.reported()
    for block in case.blocks().values():
        assert np.median(np.linalg.norm(block.acc_m_s2, axis=1)) == pytest.approx(10.5, abs=1.5)
        assert np.isfinite(block.gyr_rad_s).all()


def is_read_as_reference(case: Case, name: str) -> None:
    """It is read, and so it is the missing session that is refused."""
    outcome = case.run("agree", "none", "--reference", name, "--out", case.out)
    assert outcome.code == 2
    assert "none" in outcome.text
    assert name not in outcome.text
    assert read_reference(Path(name)).trials


def csv_na_cells(case: Case) -> None:
    read_whole(case, case.import_two())
    for block in case.blocks().values():  # every fiftieth row has no value: it is missing
        assert np.flatnonzero(np.diff(block.time_s) > 0.015).tolist()[:3] == [48, 97, 146]


def csv_packet_numbers(case: Case) -> None:
    outcome = case.import_two("--rate", "100")
    assert "other packets" in outcome.text


def csv_stamps_in_batches(case: Case) -> None:
    read_whole(case, case.import_two())
    assert "stamps_spread" in case.reported()
    for block in case.blocks().values():
        np.testing.assert_allclose(np.diff(block.time_s), 0.01, atol=1e-5)


def dot_last_rows_short(case: Case) -> None:
    assert case.import_two().code == 0
    assert len(case.blocks()) == 2
    assert "rows_cut_short" in case.reported()


def is_read(case: Case) -> None:
    read_whole(case, case.import_two())


RIGHT: Mapping[str, Callable[[Case], None]] = {
    "acc-and-gyro-apart": acc_and_gyro_apart,
    "c3d-frames-float": lambda case: is_read_as_reference(case, "framesfloat.c3d"),
    "c3d-over-65535-frames": c3d_over_65535_frames,
    "clipped-at-2g": clipped_at_2g,
    "clock-jumps-forward": clock_jumps_forward,
    "csv-NA-cells": csv_na_cells,
    "csv-packet-numbers": csv_packet_numbers,
    "csv-preamble": is_read,
    "csv-sep-line": is_read,
    "csv-stamps-in-batches": csv_stamps_in_batches,
    "decimal-comma-dot": is_read,
    "decimal-comma-reference": lambda case: is_read_as_reference(case, "comma.csv"),
    "dot-every-second-lost": dot_every_second_lost,
    "dot-last-rows-short": dot_last_rows_short,
    "pause-in-a-walk": pause_in_a_walk,
    "witmotion-app-csv": is_read,
    "xdf-block-jumps": xdf_block_jumps,
    "xdf-no-clock-offsets": xdf_no_clock_offsets,
    "xdf-one-name-one-source": xdf_one_name_one_source,
    "xdf-stamps-step-back": xdf_stamps_step_back,
    "ximu3-restarted": ximu3_restarted,
}
LONG = {"c3d-over-65535-frames"}


def marked(name: str) -> Any:
    return pytest.param(name, marks=[pytest.mark.endurance] if name in LONG else [])


@pytest.fixture
def case(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], request: pytest.FixtureRequest
) -> Case:
    """Files are read in this process, as the limited one reads them."""
    read_here: dict[str, Any] = {
        "read_foreign_session": lambda folder, _waiting: read_session(folder),
        "read_foreign_reference": lambda path, _waiting: read_reference(path),
        "write_over_session": write_session,
        "read_foreign_trial": lambda name, files, rate_hz, _waiting, choices, splits: read_trial(
            name, files, rate_hz, choices, splits=splits
        ),
    }
    patched = set()
    for module in (agree, import_files, places):
        for name in read_here.keys() & vars(module).keys():
            monkeypatch.setattr(module, name, read_here[name])
            patched.add(name)
    assert patched == read_here.keys()  # else some are read elsewhere now
    monkeypatch.setattr(analysed_folder, "analyse", lambda session, *_: analysis_of(session))
    return Case(tmp_path / "out", capsys)


@pytest.mark.parametrize("name", [marked(name) for name in RIGHT])
def test_each_case_comes_out_as_its_readme_states(
    test_data: Callable[[str], Path], case: Case, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(shutil.copytree(test_data(CASES) / name, case.out.with_name(name)))
    RIGHT[name](case)


def test_every_case_has_its_right_outcome(test_data: Callable[[str], Path]) -> None:
    assert {folder.name for folder in test_data(CASES).iterdir()} == set(RIGHT)

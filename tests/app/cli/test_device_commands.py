"""The command line lists sensors and plays some; every driver's journals are read; a port that vanishes comes back."""

import os
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from app.cli.arguments import EMULATED
from app.cli.devices import MOVEMENTS, emulate, list_devices
from app.cli.main import main
from core.body import Site
from core.session import RecordingKind
from devices.catalogue import DRIVERS
from devices.emulators.patient import FINE_HZ, KINDS, EmulatedPatient
from devices.transport.ports import MORE_PORTS
from tests.safety.port_vanishes import vanish_often
from tests.safety.vanishing import BACK

pytestmark = pytest.mark.endurance  # minutes in all: the default run has three


@pytest.mark.parametrize("kind", [kind for kind in EMULATED if kind != "csv"])  # whose columns have to be reported
def test_what_is_played_is_listed(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    reported: list[str] = []
    playing = threading.Thread(target=emulate, args=(kind, 2, 8.0, reported.append, ["f"]))
    playing.start()
    while len(reported) < 5:
        time.sleep(0.05)
    assert all(Path(place).exists() for place in reported[:2])
    monkeypatch.setenv(MORE_PORTS, os.pathsep.join(reported[:2]))
    lines = list(list_devices())
    playing.join()
    assert lines[0] == "Sensors found:"
    assert "free motion 1: 6 s" in reported
    assert sum(line.startswith("- ") and line.endswith(", simulated") for line in lines) == 2
    assert sum(driver.proof in line for driver in DRIVERS for line in lines) == len(DRIVERS)
    assert not any(Path(place).exists() for place in reported[:2])


def test_what_is_played_is_the_simulated_patient() -> None:
    assert EMULATED == KINDS
    assert {RecordingKind(kind) for kind in MOVEMENTS.values()} == set(RecordingKind)
    patient = EmulatedPatient()
    clip = patient.ask(RecordingKind.WALKING)
    chance = np.random.default_rng(1)
    for recording, start_ns in (
        (clip.recording, clip.start_ns),
        (patient.simulated.session.recordings[0], clip.end_ns),
    ):
        block = recording.imu[Site.LEFT_SHANK]
        for row in range(0, 4000, 501):
            at_ns = start_ns + row * 1e9 / FINE_HZ
            rate, force = np.split(patient.measured(Site.LEFT_SHANK, at_ns, 100.0, chance), 2)
            assert rate == pytest.approx(block.gyr_rad_s[row], abs=0.01)
            assert force == pytest.approx(block.acc_m_s2[row], abs=0.1)


def test_a_kind_that_is_not_known_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["devices", "--emulate", "toaster"])
    assert "toaster is none of ximu3, witmotion, csv" in capsys.readouterr().err


@pytest.mark.parametrize("count", [4, pytest.param(20, marks=pytest.mark.endurance)])
def test_a_port_vanishes_and_comes_back_while_the_others_lose_nothing(tmp_path: Path, count: int) -> None:
    vanished = vanish_often(tmp_path, count, seed=3)
    assert vanished.faults == []
    assert len(vanished.figures[BACK]) == count

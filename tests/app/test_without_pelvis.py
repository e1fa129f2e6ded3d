"""A session of six sensors is analysed as it was before there was a seventh, byte for byte."""

import json
from dataclasses import replace

import pytest

from devices.simulation.walker import Walk
from tests.app.six_sensors import GOLDEN, SESSIONS, digests, machine, structure, vectors, written
from tests.simulated import session_of

REPORTED = json.loads(GOLDEN.read_text(encoding="utf-8"))


@pytest.mark.endurance
@pytest.mark.parametrize("case", SESSIONS)
def test_six_sensors_give_the_tables_that_they_gave_before(case: str) -> None:
    files = written(session_of(SESSIONS[case]))
    assert structure(files) == REPORTED["structure"][case]
    if machine() == REPORTED["machine"] and vectors() in REPORTED["digests"]:  # others round other last digits
        assert digests(files) == REPORTED["digests"][vectors()][case]


@pytest.mark.endurance
def test_another_walk_gives_other_bytes() -> None:
    settings = SESSIONS["rigid"]
    walk = replace(settings.recordings[-1], speed_m_s=1.2) if isinstance(settings.recordings[-1], Walk) else Walk()
    files = written(session_of(replace(settings, recordings=(*settings.recordings[:-1], walk))))
    assert structure(files) == REPORTED["structure"]["rigid"]
    assert digests(files) not in [of_processor["rigid"] for of_processor in REPORTED["digests"].values()]

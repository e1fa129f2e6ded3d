"""Two stations that edit the same at once lose nothing; and what would be lost is noticed."""

from pathlib import Path

import pytest

from tests.driver import Found
from tests.safety.concurrent_edits import judge, open_station, prepare, run

ROOT = Path(__file__).parents[3]


@pytest.fixture(autouse=True)
def _stations_find_the_tests(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(ROOT)  # which a station is given by the process that starts it


@pytest.mark.endurance
@pytest.mark.parametrize("kind", ["file", "server"])
def test_no_acknowledged_edit_of_two_stations_is_lost(
    kind: str, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    url = str(tmp_path) if kind == "file" else str(request.getfixturevalue("postgres_url"))
    verdict = run(url, edits=250)
    assert verdict.faults == []
    assert verdict.count["values acknowledged"] > 500
    assert min(verdict.count["contested"], verdict.count["merged of the other's"]) > 5  # how often they meet is chance


def judged(folder: Path, is_old: bool, stated: str = "knee B") -> Found:
    """What is found where one station writes over another's word; `is_old`: reported that it was shown what was
    before."""
    things = prepare(str(folder))
    patient = things[0]
    for code, base, word in (("aa", "", "knee A"), ("bb", "knee A", "knee B")):
        with open_station(str(folder)) as station:
            station.log_in(code)
            station.edits.patient(patient.id, {"device": base}, {"device": word})
    reported = {"row": str(patient.id), "table": "patients", "field": "device", "is_contested": False}
    logs = {
        "aa": [{**reported, "upon": "", "said": "knee A"}],
        "bb": [{**reported, "upon": "" if is_old else "knee A", "said": stated}],
    }
    return judge(str(folder), things, logs)


@pytest.mark.endurance
def test_a_word_that_was_written_over_unseen_or_is_in_no_history_is_a_fault(tmp_path: Path) -> None:
    for name in ("well", "unseen", "nowhere"):
        (tmp_path / name).mkdir()
    assert judged(tmp_path / "well", is_old=False).faults == []
    (unseen,) = judged(tmp_path / "unseen", is_old=True).faults
    assert unseen.endswith("overwrote knee A unseen")
    (nowhere,) = judged(tmp_path / "nowhere", is_old=False, stated="knee C").faults
    assert '"knee C" of bb is not in the history' in nowhere

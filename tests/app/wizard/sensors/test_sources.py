"""What is found is listed by its driver and opened, and the screen never waits for a search."""

import threading
import time
from typing import NoReturn

import pytest
from pytestqt.qtbot import QtBot
from syrupy.assertion import SnapshotAssertion

from app.acquisition.acquisition import Acquisition
from app.wizard.sensors import sources as sources_module
from app.wizard.sensors.sources import DEMONSTRATION, SEARCH, WITH_PELVIS, Sources, choices
from app.wizard.worn_sensors import SetUpFirstError, SourceChoice, WornSensors
from core.alignment import NetChange, ProsthesisPart
from core.body import Side
from core.prosthesis import NOT_STATED, AmputationLevel, FootKind, Prosthesis
from core.session import Patient
from devices.dot.samples import DRIVER as MOVELLA_DOT
from devices.live import LiveSource, SourceRefusedError
from devices.search import FoundSensor, Passed, SearchResult
from devices.simulation.replay import ReplaySource
from devices.transport.bluetooth import BluetoothMissingError
from devices.transport.ports import PortInfo
from tests.safety.live_material import numbered_session

REFUSED = Passed(
    PortInfo("COM7"),
    SourceRefusedError("{place} is in use by another program", "Close that program, then search again", place="COM7"),
)


def sensor(name: str, driver: str = "ximu3", is_simulated: bool = False) -> FoundSensor:
    def make() -> LiveSource:
        return ReplaySource(numbered_session(name, 1), name=name)

    return FoundSensor(driver, name, "here", make, is_simulated)


def found_by(found: SearchResult) -> Sources:
    sources = Sources(lambda: found)
    sources.look()
    sources.wait()
    return sources


def test_the_list_is_there_at_once_and_grows(qtbot: QtBot) -> None:
    may_end = threading.Event()

    def search() -> SearchResult:
        may_end.wait(10)
        assert threading.current_thread() is not threading.main_thread()
        return SearchResult((sensor("A"), sensor("B"), sensor("C", "witmotion", is_simulated=True)))

    sources = Sources(search)
    begin_s = time.monotonic()
    sources.look()
    assert [one.key for one in sources] == [DEMONSTRATION, SEARCH, WITH_PELVIS]
    assert time.monotonic() - begin_s < 0.5
    may_end.set()
    qtbot.waitUntil(lambda: len(sources) == 5)
    assert [one.key for one in sources] == [DEMONSTRATION, "ximu3", "witmotion", SEARCH, WITH_PELVIS]
    assert [one.name for one in sources][1:3] == [
        "x-io x-IMU3, 2 sensors",
        "WitMotion, standard protocol, 1 sensor",
    ]
    assert [one.is_simulated for one in sources] == [True, False, True, False, True]


def test_a_choice_opens_all_sensors_of_its_driver() -> None:
    sources = found_by(SearchResult((sensor("A"), sensor("B"), sensor("C", "witmotion"))))
    acquisition = sources[1].make()
    try:
        acquisition.start()
        assert acquisition.sensors == ("A-left_thigh", "B-left_thigh")
    finally:
        acquisition.close()


def test_a_search_looks_again_and_opens_whatever_is_there() -> None:
    every = [SearchResult(), SearchResult((sensor("A"), sensor("C", "witmotion")))]
    sources = Sources(lambda: every.pop(0))
    sources.look()
    sources.wait()
    assert len(sources) == 3
    acquisition = sources[-2].make()
    try:
        acquisition.start()
        assert len(acquisition.sensors) == 2
    finally:
        acquisition.close()
    assert len(sources) == 5


def test_where_nothing_is_found_it_states_why_and_what_bluetooth_lacks(snapshot: SnapshotAssertion) -> None:
    stated = {}
    for case, found in {
        "nothing is there": SearchResult(),
        "the only one is in use": SearchResult((), (REFUSED,)),
        "several are in use": SearchResult((), (REFUSED,) * 2),
        "Bluetooth is not installed": SearchResult(deaf=BluetoothMissingError("a", "b")),
        "Bluetooth is off": SearchResult(deaf=SourceRefusedError("a", "b")),
    }.items():
        with pytest.raises(SourceRefusedError) as refused:
            found_by(found)[-2].make()
        stated[case] = str(refused.value)
    assert stated == snapshot


def test_a_search_that_fails_leaves_the_rest(caplog: pytest.LogCaptureFixture) -> None:
    def search() -> SearchResult:
        raise OSError("the port library does not load")

    sources = Sources(search)
    sources.look()
    sources.wait()
    assert "could not be looked for" in caplog.text
    assert [one.key for one in sources] == [DEMONSTRATION, SEARCH, WITH_PELVIS]


def test_the_machines_own_search_begins_with_the_list(monkeypatch: pytest.MonkeyPatch, qtbot: QtBot) -> None:
    monkeypatch.setattr(sources_module, "_search", lambda: SearchResult((sensor("A"),)))
    monkeypatch.setattr(sources_module, "_networks", tuple)
    listed = choices()
    qtbot.waitUntil(lambda: len(listed) == 4)


def test_streams_are_asked_for_by_a_choice_only_that_states_whom(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []

    def search_streams(address: str) -> SearchResult:
        asked.append(address)
        return SearchResult((sensor("A", "lsl"),)) if address == "192.0.2.9" else SearchResult()

    monkeypatch.setattr("app.wizard.sensors.sources.search_streams", search_streams)
    sources = Sources(SearchResult, ("127.0.0.1", "192.0.2.9"))
    sources.look()
    sources.wait()
    *_, search, here, network, _with_pelvis = sources
    assert (search.key, asked) == (SEARCH, [])
    assert (here.name, here.asks) == ("Streams from programs on this computer", ("", ""))
    assert network.name == "Streams on the network of 192.0.2.9"
    assert network.asks == (
        "This asks every computer on the network of 192.0.2.9 for sensor streams, by UDP to 224.0.0.183, port "
        "16571. It then contacts the computers that answer. No patient data are sent.",
        "Choose the source again to start the query.",
    )
    with pytest.raises(SourceRefusedError, match="No stream with motion data found"):
        here.make()
    with pytest.raises(SourceRefusedError, match="No sensor found"):
        search.make()
    assert asked == ["127.0.0.1"]
    network.make().close()
    assert asked == ["127.0.0.1", "192.0.2.9"]


@pytest.mark.parametrize(
    ("side", "is_user"), [("", False), ("none", False), ("left", True), ("right", True), ("both", False)]
)
def test_a_patient_with_one_prosthesis_is_simulated_with_it(side: str, is_user: bool) -> None:
    simulated = Sources(lambda: SearchResult(()))[0].for_patient(Patient(prosthetic_side=side))
    assert simulated.key == DEMONSTRATION
    assert (simulated.make != Sources(lambda: SearchResult(()))[0].make) is is_user
    if side == "left":
        acquisition = simulated.make()
        acquisition.set_up(
            [NetChange(ProsthesisPart.PYLON, height_mm=3.0)]
        )  # who is simulated with none receives nothing
        assert acquisition.is_simulated
        acquisition.close()


def test_the_simulated_patient_wears_what_was_stated_of_the_side_that_is_prosthetic(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made: list[tuple[Side, Prosthesis]] = []

    def user(side: Side, _settings: object, *, fitted: Prosthesis) -> NoReturn:
        made.append((side, fitted))
        raise SourceRefusedError("no patient", "none needed")

    monkeypatch.setattr(sources_module, "ProsthesisUser", user)
    transtibial = Prosthesis(AmputationLevel.TRANSTIBIAL, foot=FootKind.SACH)
    patient = Patient(prosthetic_side="right", prostheses={Side.RIGHT: transtibial, Side.LEFT: Prosthesis()})
    for one in (patient, Patient(prosthetic_side="left", prostheses={Side.RIGHT: transtibial})):
        choice = Sources(lambda: SearchResult(()))[0].for_patient(one)
        with pytest.raises(SourceRefusedError, match="no patient"):
            choice.make()
    assert made == [(Side.RIGHT, transtibial), (Side.LEFT, NOT_STATED)]


def test_dots_are_set_up_before_they_are_opened_and_others_are_opened_without_them(qtbot: QtBot) -> None:
    alone = found_by(SearchResult((sensor("A", MOVELLA_DOT), sensor("B", MOVELLA_DOT))))
    by_key = {one.key: one for one in alone}
    assert by_key[MOVELLA_DOT].make_fleet is not None
    with pytest.raises(SetUpFirstError) as refused:
        by_key[SEARCH].make()
    assert refused.value.key == MOVELLA_DOT
    mixed = {one.key: one for one in found_by(SearchResult((sensor("A", MOVELLA_DOT), sensor("B"))))}
    assert mixed["ximu3"].make_fleet is None
    acquisition = mixed[SEARCH].make()
    acquisition.start()
    assert {one.partition("-")[0] for one in acquisition.sensors} == {"B"}
    acquisition.close()


def test_sensors_that_have_to_be_set_up_are_reported_by_their_key(qtbot: QtBot) -> None:
    sensors = WornSensors(None)  # type: ignore[arg-type]  # it belongs to nobody

    def make() -> Acquisition:
        raise SetUpFirstError(MOVELLA_DOT)

    with qtbot.waitSignal(sensors.set_up_required) as required, qtbot.assertNotEmitted(sensors.refused):
        sensors.search(SourceChoice(SEARCH, "Search", make))
    assert required.args == [MOVELLA_DOT]
    sensors.finish()


@pytest.mark.endurance
def test_a_patient_is_simulated_with_a_seventh_sensor_where_that_is_chosen() -> None:
    acquisition = found_by(SearchResult())[-1].make()
    try:
        acquisition.start()
        assert len(acquisition.sensors) == 7
        assert acquisition.is_simulated
    finally:
        acquisition.close()

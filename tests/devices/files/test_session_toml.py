"""Each key of `session.toml` is understood, and a wrong one is refused in words."""

import tomllib

import numpy as np
import pytest
from syrupy.assertion import SnapshotAssertion

from core.alignment import AlignmentChange, PartChange, ProsthesisPart
from core.body import Joint, Side, Site
from core.prosthesis import AmputationLevel, FootKind, KneeKind, Prosthesis
from core.samples import RateKind, SensorInfo
from core.session import Patient
from core.timed.protocols import PlannedTest, TimedProtocol
from devices.files.session_toml import default_sensor, parse, render, unknown_keys
from tests.devices.files.conftest import TOML
from tests.trials_of_files import refused

GOAL = {"measure": "speed_m_s", "of": "both", "value": 1.2, "agreed": "2026-01-05", "by": "hk"}


def test_goals_are_read_and_written_and_what_is_none_stays_as_it_was() -> None:
    head = 'format = "gaitwright-session/1"\n[patient]\ncode = "P-1"\n'
    recording = '[[recordings]]\nname = "walk 1"\nkind = "walking"\nfolder = "walk_1"\n'
    goals = '[[patient.goals]]\nmeasure = "speed_m_s"\nof = "both"\nvalue = 1.2\nagreed = "2026-01-05"\nby = "hk"\n'
    session, plans = parse(head + goals + recording)
    (goal,) = session.patient.goals
    assert (goal.column, goal.of, goal.value, goal.agreed.isoformat(), goal.by) == tuple(GOAL.values())
    assert tomllib.loads(render(session, plans))["patient"]["goals"] == [GOAL]
    other = goals.replace("speed_m_s", "hop_height_m")
    kept, plans = parse(head + other + recording)
    assert kept.patient.goals == ()
    assert tomllib.loads(render(kept, plans))["patient"]["goals"] == [GOAL | {"measure": "hop_height_m"}]
    assert [finding.numbers["name"] for finding in unknown_keys(kept)] == ["goals"]


WORN = """\
format = "gaitwright-session/1"
[patient]
prosthetic_side = "both"
[patient.prosthesis.left]
level = "transfemoral"
knee = "polycentric"
foot = "sach"
[patient.prosthesis.right]
level = "transtibial"
[[recordings]]
name = "walk 1"
kind = "walking"
folder = "walk_1"
"""


def test_each_side_s_prosthesis_is_read_and_written() -> None:
    session, plans = parse(WORN)
    assert session.patient.worn == {
        Side.LEFT: Prosthesis(AmputationLevel.TRANSFEMORAL, KneeKind.POLYCENTRIC, FootKind.SACH),
        Side.RIGHT: Prosthesis(AmputationLevel.TRANSTIBIAL),
    }
    assert unknown_keys(session) == ()
    assert tomllib.loads(render(session, plans))["patient"] == tomllib.loads(WORN)["patient"]


@pytest.mark.parametrize(
    "later",
    [
        WORN.replace('"sach"', '"magnetic"'),
        WORN.replace('"transtibial"', '"transtibial"\nliner = "gel"'),
        WORN.replace("[patient.prosthesis.left]", "[patient.prosthesis.middle]"),
        WORN.replace('"transfemoral"', '"transpelvic"'),
    ],
)
def test_what_a_later_version_states_of_a_prosthesis_is_noticed_and_stays(later: str) -> None:
    session, plans = parse(later)
    assert [(finding.where, finding.numbers["name"]) for finding in unknown_keys(session)] == [
        ("patient", "prosthesis")
    ]
    assert tomllib.loads(render(session, plans))["patient"] == tomllib.loads(later)["patient"]
    assert parse(render(session, plans)) == (session, plans)
    assert session.patient.worn[Side.RIGHT] == Prosthesis(AmputationLevel.TRANSTIBIAL)


@pytest.mark.parametrize(
    "other",
    [
        '[patient]\nprosthesis = "C-Leg"',
        "[patient]\nprosthesis = 3",
        '[patient]\nprosthesis = ["left"]',
        'alignment = "neutral"',
        'alignment = { since = "A", parts = [{ part = "hip", turns = 1 }] }',
        'test = "6 min"\ntest_laps = 2.5',
        'test = "6 min"\ntest_laps = -1',
        'test = "6 min"\ntest_lap_m = 0',
        'test = "up and go"\ntest_course_m = "three"',
        'test = "100 m"',
        "test = 10",
        "test_end_s = 3.0",
        'test = "10 m"\ntest_start_s = 5.0\ntest_end_s = 4.0',
        'test = "10 m"\ntest_end_s = "later"',
    ],
)
def test_what_another_program_calls_a_prosthesis_an_alignment_or_a_test_is_unknown_and_stays(other: str) -> None:
    session, plans = parse(f"{TOML}{other}\n")
    patient, recording = session.patient, plans[0].recording
    assert (patient.prostheses, recording.alignment, recording.test) == ({}, None, None)
    stated = {line.split(" = ")[0] for line in other.removeprefix("[patient]\n").split("\n")}
    assert {*patient.unknown, *recording.unknown} == stated
    assert parse(render(session, plans)) == (session, plans)


def test_a_session_that_states_no_prosthesis_is_written_as_before() -> None:
    session, plans = parse(f'{TOML}[patient]\nprosthetic_side = "left"\n')
    assert (session.patient.prostheses, session.patient.unknown) == ({}, {})
    assert tomllib.loads(render(session, plans))["patient"] == {"prosthetic_side": "left"}


def test_every_key_of_the_format_is_read() -> None:
    toml = """\
        format = "gaitwright-session/1"
        [session]
        started = 2024-05-01T10:00:00
        operator = "N. N."
        surface = "carpet"
        notes = "none"
        software = "x 1"
        simulated = true
        [patient]
        code = "P-001"
        birth_year = 1950
        sex = "f"
        height_m = 1.7
        mass_kg = 70
        device = "AFO"
        aids = "stick"
        affected_side = "left"
        prosthetic_side = "none"
        [sensors.left_thigh]
        serial = "A1"
        model = "M"
        firmware = "1.2"
        rate_hz = 100
        rate_kind = "averaged"
        clock = "receiver 1"
        [zero]
        left_knee = 5
        [sign]
        left_knee = -1
        right_ankle = 1
        [[recordings]]
        name = "walk 1"
        kind = "walking"
        folder = "walk_1"
        condition = "alignment A"
        started = "2024-05-01T10:01:00"
        kept = false
        note = "slow"
        restrapped_before = true
        """
    session, plans = parse(toml)
    assert unknown_keys(session) == ()
    assert (session.started, session.operator, session.surface) == ("2024-05-01T10:00:00", "N. N.", "carpet")
    assert (session.notes, session.software, session.is_simulated) == ("none", "x 1", True)
    assert session.patient == Patient("P-001", 1950, "f", 1.7, 70.0, "AFO", "stick", "left", "none")
    assert session.sensors == {Site.LEFT_THIGH: SensorInfo("A1", "M", "1.2", 100.0, RateKind.AVERAGED, "receiver 1")}
    assert session.zero_rad == {Joint.LEFT_KNEE: pytest.approx(np.radians(5.0))}
    assert session.turned_sign == {Joint.LEFT_KNEE: -1, Joint.RIGHT_ANKLE: 1}
    recording = plans[0].recording
    assert (recording.condition, recording.started, recording.note) == ("alignment A", "2024-05-01T10:01:00", "slow")
    assert (recording.is_kept, recording.is_restrapped_before) == (False, True)
    assert [default_sensor(session, site) for site in (Site.LEFT_THIGH, Site.LEFT_FOOT)] == ["A1", "left_foot"]
    assert parse(render(session, plans)) == (session, plans)


RECORDING = TOML.partition("\n")[2]
WRONG = {
    "no format": RECORDING,
    "a later format": TOML.replace("gaitwright-session/1", "gaitwright-session/2"),
    "the format of others": TOML.replace("gaitwright-session/1", "other/1"),
    "a number as format": TOML.replace('"gaitwright-session/1"', "1"),
    "no recording": 'format = "gaitwright-session/1"',
    "an empty list of recordings": 'format = "gaitwright-session/1"\nrecordings = []',
    "recordings that are a number": 'format = "gaitwright-session/1"\nrecordings = 5',
    "no name": TOML.replace('name = "walk 1"', ""),
    "no kind": TOML.replace('kind = "walking"', ""),
    "no folder": TOML.replace('folder = "walk_1"', ""),
    "a blank name": TOML.replace('"walk 1"', '" "'),
    "an unknown kind": TOML.replace('"walking"', '"running"'),
    "two of a name": TOML + RECORDING.replace("walk_1", "walk_2"),
    "two in a folder": TOML + RECORDING.replace("walk 1", "walk 2"),
    "two in a folder by other names": TOML + '[[recordings]]\nname="b"\nkind="walking"\nfolder="./walk_1/"',
    "a part that is a number": "zero = 5\n" + TOML,
}
FOLDERS = ('"../session/walk_1"', '"/tmp"', '"C:/walk"', '"a\\\\..\\\\..\\\\b"', '"."', '""', "1")
ADDED = """\
kept = 1
zero: left_knee = "5"
zero: left_knee = nan
zero: left_knee = 200
zero: left_knee = true
sign: left_knee = 0
sign: left_knee = true
patient: affected_side = "port"
patient: prosthetic_side = ["left"]
patient: height_m = 170
patient: mass_kg = -1
patient: birth_year = 50
patient: code = 5
session: simulated = 1
sensors: left_thigh = 5
sensors.left_thigh: rate_hz = 0
sensors.left_thigh: rate_kind = "mean"
"""


def test_what_is_wrong_is_refused(snapshot: SnapshotAssertion) -> None:
    wrong = WRONG | {f"folder = {folder}": TOML.replace('"walk_1"', folder) for folder in FOLDERS}
    for line in ADDED.splitlines():
        part, _, key = line.rpartition(": ")
        wrong[line] = f"{TOML}[{part}]\n{key}" if part else TOML + key
    assert {case: refused(parse, toml) for case, toml in wrong.items()} == snapshot


@pytest.mark.parametrize("text", ["format = ", "x = " + "[" * 5000, "x = " + "9" * 5000])
def test_what_python_s_reader_refuses_is_no_toml(text: str) -> None:
    assert refused(parse, text).startswith("session.toml: the file is not TOML (")  # then in Python's words


@pytest.mark.parametrize(
    "deep", ["a = " + "[" * 60 + "]" * 60, "a = " + "{b = " * 60 + "1" + "}" * 60, "[a" + ".a" * 60 + "]"]
)
def test_tables_without_end_within_each_other_are_refused(deep: str) -> None:
    text = f"{deep}\n{TOML}" if deep.startswith("a") else f"{TOML}{deep}\n"
    assert "the tables in the file are nested too deeply" in refused(parse, text)
    shallow = "a = " + "[" * 40 + "]" * 40
    assert "a" in parse(f"{shallow}\n{TOML}")[0].unknown


def test_what_was_changed_at_a_prosthesis_is_read_and_written_again() -> None:
    changed = """\
condition = "Alignment B"
[recordings.alignment]
since = "Alignment A"
parts = [
    { part = "foot_front_screw", angle_deg = 2, turns = 0.5 },
    { part = "pylon", height_mm = 3.0, text = "new clamp" },
]
"""
    session, plans = parse(TOML + changed)
    front = PartChange(ProsthesisPart.FOOT_FRONT_SCREW, angle_deg=2.0, turns=0.5)
    pylon = PartChange(ProsthesisPart.PYLON, height_mm=3.0, text="new clamp")
    assert plans[0].recording.alignment == AlignmentChange("Alignment A", (front, pylon))
    assert plans[0].recording.unknown == {}
    assert parse(render(session, plans)) == (session, plans)


def test_which_test_a_walk_is_is_read_and_written_again_with_its_keys() -> None:
    session, plans = parse(TOML + 'test = "10 m"\ntest_start_s = 3\ntest_end_s = 12.25\n')
    assert plans[0].recording.test == PlannedTest(TimedProtocol.TEN_METRES, 3.0, 12.25)
    assert plans[0].recording.unknown == {}
    assert parse(render(session, plans)) == (session, plans)


def test_what_was_entered_of_a_test_is_read_and_written_again() -> None:
    entered = 'test = "6 min"\ntest_course_m = 3\ntest_lap_m = 30.0\ntest_laps = 11\ntest_rest_m = 12.5\n'
    session, plans = parse(TOML + entered)
    assert plans[0].recording.test == PlannedTest(TimedProtocol.SIX_MINUTES, None, None, 3.0, 30.0, 11, 12.5)
    assert plans[0].recording.unknown == {}
    assert parse(render(session, plans)) == (session, plans)

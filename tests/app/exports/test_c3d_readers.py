"""Read our C3D files with programs of other authors: values, units, rate, events and what they are of."""

import csv
import io
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import ezc3d
import numpy as np
import pytest

from app.exports.c3d_angles import write_c3d
from core.body import Joint
from core.results import RecordingAnalysis
from core.samples import FloatArray
from devices.files.references.reading import read_reference
from tests.app.exports.test_parts import longer
from tests.other_programs import ask_python

ANGLES = {
    "LKneeAngles": "left_knee",
    "RKneeAngles": "right_knee",
    "LAnkleAngles": "left_ankle",
    "RAnkleAngles": "right_ankle",
}
NAMES = {
    "initial_contact": "Foot Strike",
    "toe_off": "Foot Off",
    "full_contact": "Full Contact",
    "heel_rise": "Heel Rise",
}
CODE = "P-7Q2M4XKA"


@pytest.fixture(scope="module")
def written(walk: RecordingAnalysis, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("c3d") / "angles.c3d"
    write_c3d(walk, True, path, CODE)
    return path


@dataclass(frozen=True)
class Expected:
    """What angles.csv and events.csv have, as a C3D gives it: events from the first row, strikes and offs first."""

    angles_deg: Mapping[str, FloatArray]
    rate_hz: float
    events: list[tuple[str, str, float]]


@pytest.fixture(scope="module")
def expected(walk: RecordingAnalysis, tables: Path) -> Expected:
    def rows(name: str) -> list[dict[str, str]]:
        text = (tables / walk.folder / name).read_text(encoding="utf-8")
        return list(csv.DictReader(io.StringIO(text)))

    angles = rows("angles.csv")
    start_s = float(angles[0]["time_s"])
    events = [
        (one["side"].capitalize(), NAMES[one["event"]], float(one["time_s"]) - start_s) for one in rows("events.csv")
    ]
    events.sort(key=lambda one: (not one[1].startswith("Foot "), one[2]))
    columns = {name: np.array([float(row[f"{joint}_deg"]) for row in angles]) for name, joint in ANGLES.items()}
    return Expected(columns, (len(angles) - 1) / (float(angles[-1]["time_s"]) - start_s), events)


def check(found: Mapping[str, Any], expected: Expected, *, has_sides: bool = True) -> None:
    """Labels, angles (n,) by label, rate, units, events as (side, label, seconds)."""
    assert sorted(found["angles"]) == sorted(ANGLES)
    assert found["rate"] == pytest.approx(expected.rate_hz, rel=1e-4)
    assert set(found["units"]) == {"deg"}
    for label, values in found["angles"].items():
        np.testing.assert_array_equal(np.array(values, dtype=np.float32), expected.angles_deg[label].astype(np.float32))
    events = expected.events if has_sides else [("", label, time_s) for _, label, time_s in expected.events]
    assert [tuple(one[:2]) for one in found["events"]] == [one[:2] for one in events]
    np.testing.assert_allclose([one[2] for one in found["events"]], [one[2] for one in events], atol=1e-4)


def test_ezc3d_reads_angles_units_and_events(written: Path, expected: Expected) -> None:
    read = ezc3d.c3d(str(written))
    parameters = read["parameters"]
    event = parameters["EVENT"]
    labels = parameters["POINT"]["LABELS"]["value"]
    minutes, seconds = event["TIMES"]["value"]
    check(
        {
            "angles": dict(zip(labels, read["data"]["points"][0], strict=True)),
            "rate": parameters["POINT"]["RATE"]["value"][0],
            "units": parameters["POINT"]["UNITS"]["value"],
            "events": list(
                zip(event["CONTEXTS"]["value"], event["LABELS"]["value"], 60 * minutes + seconds, strict=True)
            ),
        },
        expected,
    )
    icons = {"Foot Strike": 1, "Foot Off": 2}  # as those who defined these events number them
    assert list(event["ICON_IDS"]["value"]) == [icons.get(label, 0) for label in event["LABELS"]["value"]]
    words = dict(zip(event["LABELS"]["value"], event["DESCRIPTIONS"]["value"], strict=True))
    assert words["Foot Strike"] == "The instant the heel strikes the ground"
    assert words["Foot Off"] == "The instant the toe leaves the ground"
    count = event["USED"]["value"][0]
    assert event["SUBJECTS"]["value"] == [CODE] * count == parameters["SUBJECTS"]["NAMES"]["value"] * count
    assert list(event["GENERIC_FLAGS"]["value"]) == [0] * count
    context = parameters["EVENT_CONTEXT"]
    assert (context["USED"]["value"][0], context["LABELS"]["value"]) == (2, ["Left", "Right"])
    assert context["COLOURS"]["value"].shape == (3, 2)
    assert parameters["SUBJECTS"]["USED"]["value"][0] == 1
    assert parameters["SUBJECTS"]["IS_STATIC"]["value"][0] == parameters["SUBJECTS"]["USES_PREFIXES"]["value"][0] == 0


def test_c3d_reads_angles_units_and_events(written: Path, expected: Expected) -> None:
    c3d = pytest.importorskip("c3d", reason="the package c3d is not installed")
    with written.open("rb") as file, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # there is no analog channel
        reader = c3d.Reader(file)
        frames = np.stack([points[:, 0] for _, points, _ in reader.read_frames()])
    labels = [label.strip() for label in reader.point_labels]

    def words(name: str) -> list[str]:
        return [text.strip() for text in reader.get(name).string_array]

    minutes, seconds = reader.get("EVENT:TIMES").float_array.reshape(-1, 2).T
    check(
        {
            "angles": dict(zip(labels, frames.T, strict=True)),
            "rate": reader.point_rate,
            "units": words("POINT:UNITS"),
            "events": list(zip(words("EVENT:CONTEXTS"), words("EVENT:LABELS"), 60 * minutes + seconds, strict=True)),
        },
        expected,
    )
    assert (reader.first_frame, reader.last_frame, reader.frame_count) == (1, len(frames), len(frames))
    assert reader.get("EVENT:USED").int16_value == len(expected.events)
    assert words("SUBJECTS:NAMES") == [CODE]


KINETICS_TOOLKIT = """
import json, sys
import kineticstoolkit.lab as ktk
read = ktk.read_c3d(sys.argv[1], convert_point_unit=False)
points, parameters = read["Points"], read["C3DParameters"]
print(json.dumps({
    "angles": {name: values[:, 0].tolist() for name, values in points.data.items()},
    "units": [points.info[name]["Unit"] for name in points.data],
    "rate": 1 / float(points.time[1] - points.time[0]),
    "events": [["", one.name, float(one.time)] for one in points.events],
    "contexts": list(parameters["EVENT"]["CONTEXTS"]),
    "subjects": list(parameters["SUBJECTS"]["NAMES"]),
}))
"""


@pytest.mark.endurance
def test_kineticstoolkit_reads_angles_units_and_events(written: Path, expected: Expected) -> None:
    found = ask_python("kineticstoolkit", KINETICS_TOOLKIT, written)
    by_time = replace(expected, events=sorted(expected.events, key=lambda one: one[2]))  # as it sorts them
    found["events"].sort(key=lambda one: one[2])
    check(found, by_time, has_sides=False)
    assert found["contexts"] == [side for side, _, _ in expected.events]
    assert found["subjects"] == [CODE]


PYOMECA = """
import json, sys
import pyomeca
read = pyomeca.Markers.from_c3d(sys.argv[1])
print(json.dumps({
    "angles": {str(name): read.sel(axis="x", channel=name).values.tolist() for name in read.channel.values},
    "units": [read.attrs["units"]],
    "rate": float(read.attrs["rate"]),
    "time": [float(read.time[0]), float(read.time[-1])],
    "events": [],
}))
"""


@pytest.mark.endurance
def test_pyomeca_reads_angles_and_units(written: Path, expected: Expected) -> None:
    """It reads no events."""
    found = ask_python("pyomeca", PYOMECA, written)
    check(found, replace(expected, events=[]))
    first_s, last_s = found["time"]
    assert last_s - first_s == pytest.approx((len(expected.angles_deg["LKneeAngles"]) - 1) / expected.rate_hz, rel=1e-4)


def test_more_frames_than_a_signed_number_holds_are_counted_by_all(walk: RecordingAnalysis, tmp_path: Path) -> None:
    c3d = pytest.importorskip("c3d", reason="the package c3d is not installed")
    frames = 40_000
    write_c3d(longer(walk, frames), False, tmp_path / "angles.c3d")
    parameters = ezc3d.c3d(str(tmp_path / "angles.c3d"))["parameters"]
    assert parameters["POINT"]["LONG_FRAMES"]["value"][0] == frames
    low, high = (int(word) & 0xFFFF for word in parameters["TRIAL"]["ACTUAL_END_FIELD"]["value"])
    assert low + 65536 * high == frames
    with (tmp_path / "angles.c3d").open("rb") as file, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        reader = c3d.Reader(file)
        assert reader.frame_count == frames
        assert sum(1 for _ in reader.read_frames()) == frames


def test_who_reads_255_events_gets_those_that_bound_stance(walk: RecordingAnalysis, tmp_path: Path) -> None:
    side, gait = next(iter(walk.gait.items()))
    long = replace(walk, gait={side: replace(gait, events=gait.events * 10)})
    write_c3d(long, False, tmp_path / "angles.c3d")
    event = ezc3d.c3d(str(tmp_path / "angles.c3d"))["parameters"]["EVENT"]
    first = event["LABELS"]["value"]
    every = [label for name in event if name.startswith("LABELS") for label in event[name]["value"]]
    bounding = [label for label in every if label in ("Foot Strike", "Foot Off")]
    assert len(first) == 255 < len(every)
    assert len(bounding) <= 255
    assert first[: len(bounding)] == bounding
    times_s = [60.0, 1.0] @ event["TIMES"]["value"][:, : len(bounding)]
    assert (np.diff(times_s) >= 0).all()
    for name in ("CONTEXTS", "DESCRIPTIONS", "SUBJECTS", "ICON_IDS", "GENERIC_FLAGS"):
        assert len(event[f"{name}2"]["value"]) == len(event["LABELS2"]["value"])


def test_our_reader_of_references_gives_angles_and_events_back(walk: RecordingAnalysis, written: Path) -> None:
    file = read_reference(written)
    (trial,) = file.trials
    assert set(trial.angles) == set(walk.joints)
    for joint, (time_s, angle_rad) in trial.angles.items():
        np.testing.assert_allclose(time_s, walk.time_s - walk.time_s[0], atol=1e-4)
        np.testing.assert_allclose(angle_rad, walk.joints[joint].angle_rad, atol=np.deg2rad(2e-5))
    for side, gait in walk.gait.items():
        for name, found_s in trial.events[side].items():
            known_s = np.concatenate([getattr(one, f"{name}_s") for one in gait.events])
            np.testing.assert_allclose(found_s, np.sort(known_s[np.isfinite(known_s)]) - walk.time_s[0], atol=1e-4)


def test_a_patient_without_a_code_and_one_with_accents_are_subjects_too(
    walk: RecordingAnalysis, tmp_path: Path
) -> None:
    for code, name in (("", "Subject"), ("Müller 7", "Muller 7")):
        write_c3d(
            replace(walk, joints={Joint.LEFT_KNEE: walk.joints[Joint.LEFT_KNEE]}), False, tmp_path / "a.c3d", code
        )
        parameters = ezc3d.c3d(str(tmp_path / "a.c3d"))["parameters"]
        assert parameters["SUBJECTS"]["NAMES"]["value"] == [name]
        assert set(parameters["EVENT"]["SUBJECTS"]["value"]) == {name}

"""Meaning of each column of each CSV file. `columns.csv` has unit, sign, definition, and what it needs to be known.

What a column needs is reported in words: `zero`, `sign`, `both_clocks` (of the two legs), or `parameter`: as the figure
that its row reports does. Where that is not to be had its cells are empty, and its status states not reported.
"""

import csv
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

from app.system.tables import write_table
from core import parameters
from core.body import LEG_JOINTS, Joint, Side, hip_of
from core.parameters import BY_COLUMN, PeakWindow, QuantityClass
from core.verdicts.fitting import BY_COLUMN as OF_FITTING
from core.verdicts.quantities import EXCURSIONS_BY_COLUMN, FITTING, OF_HIPS, PARAMETERS, WINDOWS

COLUMNS = "columns.csv"
HEADER = ("file", "column", "unit", "sign", "definition", "needs")
FLEXION = {"knee": "flexion positive", "ankle": "dorsiflexion positive", "hip": "flexion positive"}
HEIGHT = "zero sign"
NEEDS = {
    QuantityClass.PEAK_TIME: "sign",
    QuantityClass.EXCURSION: "sign",
    QuantityClass.HEIGHT: HEIGHT,
    QuantityClass.BETWEEN: "both_clocks",
}
AS_PARAMETER, AS_ROW = "parameter", "as the parameter"


class ColumnMeaning(NamedTuple):
    """What a column means; `unit` None: as its name ends."""

    definition: str
    needs: str = ""
    sign: str = ""
    unit: str | None = None


def _word(definition: str) -> ColumnMeaning:
    """A column of words or counts."""
    return ColumnMeaning(definition, unit="")


def _of_stride(name: str) -> ColumnMeaning:
    """A column that strides.csv has and the parameters of other tables are."""
    needs, kind = NEEDS.get(BY_COLUMN[name].rests_on, ""), name.split("_")[0]
    sign = FLEXION[kind] if BY_COLUMN[name].rests_on is QuantityClass.HEIGHT else ""
    if name in WINDOWS:
        window = WINDOWS[name]
        what = "largest" if window.is_maximum else "smallest"
        return ColumnMeaning(f"{what} angle from {window.first} to {window.last} % of the stride", needs, sign)
    if name in EXCURSIONS_BY_COLUMN:
        excursion = EXCURSIONS_BY_COLUMN[name]
        return ColumnMeaning(f"{_extreme(excursion.high, 'largest')} less {_extreme(excursion.low, 'smallest')}", needs)
    return ColumnMeaning(BY_COLUMN[name].definition, needs, sign)


def _of_fitting(name: str) -> ColumnMeaning:
    """A column of fitting.csv."""
    sign = FLEXION["knee"] if name == "knee_terminal_extension_deg" else ""
    return ColumnMeaning(OF_FITTING[name].definition, NEEDS.get(BY_COLUMN[name].rests_on, ""), sign)


def _of_pelvis(name: str) -> ColumnMeaning:
    """A column that strides.csv has more where a sensor is worn on the pelvis."""
    quantity = BY_COLUMN[name]
    needs = ("zero" if name.startswith("pelvis") else HEIGHT) if quantity.rests_on is QuantityClass.HEIGHT else ""
    return ColumnMeaning(quantity.definition, needs, quantity.sign)


def _extreme(window: PeakWindow | None, which: str) -> str:
    return f"{which} angle from {window.first} to {window.last} %" if window else "angle at initial contact"


TIMES = {
    "start_s": ColumnMeaning("initial contact that begins the stride"),
    "full_contact_s": ColumnMeaning("the whole foot comes to the floor"),
    "heel_rise_s": ColumnMeaning("the heel leaves the floor"),
    "toe_off_s": ColumnMeaning("the foot leaves the floor"),
    "end_s": ColumnMeaning("initial contact that ends the stride"),
}
ON_CLOCK = ColumnMeaning("on the recording's clock")
SIDE = _word("left or right")
USED = _word("true where the stride counts for averages")
ANGLE_STATUS = _word(
    "data quality of the joint: read, care, withheld, range_only (its sign is not known) or no_zero (heights say "
    "nothing)"
)
N = _word("strides behind the mean")
STATUS = "read, care, withheld or not_measured: the data quality of "
OF_PART = {
    "part": _word("letter of the condition or visit"),
    "name": _word("its name"),
    "walks": _word("the walks whose strides are taken together"),
}
PARAMETER = _word("the column of strides.csv or figure of both legs that is compared")
MEAN = {
    "n": N,
    "mean": ColumnMeaning("mean over the strides used", AS_PARAMETER, AS_ROW, AS_ROW),
    "sd": ColumnMeaning("standard deviation between the strides used", AS_PARAMETER, "", AS_ROW),
}
BY_HAND = {"left_out_by_hand": _word("strides that a person left out")}
JUDGED = {
    "difference": ColumnMeaning("the first mean less the second", AS_PARAMETER, AS_ROW, AS_ROW),
    "error": ColumnMeaning("what a difference has to exceed to be real, at 95 %", AS_PARAMETER, "", AS_ROW),
    "error_sources": _word("what the error contains"),
    "status": _word("the worse data quality of the two means"),
    "verdict": _word("exceeds_error, inside_error, withheld, too_few_strides (under 10) or no_published_figure"),
}
LIKELY = {
    "low": ColumnMeaning("least of what the true difference is likely to be, at 95 %", AS_PARAMETER, AS_ROW, AS_ROW),
    "high": ColumnMeaning("most of what the true difference is likely to be, at 95 %", AS_PARAMETER, AS_ROW, AS_ROW),
    "beyond_speed": ColumnMeaning("the difference less what another walking speed makes", AS_PARAMETER, AS_ROW, AS_ROW),
    "beyond_speed_low": ColumnMeaning("least of what that is likely to be, at 95 %", AS_PARAMETER, AS_ROW, AS_ROW),
    "beyond_speed_high": ColumnMeaning("most of what that is likely to be, at 95 %", AS_PARAMETER, AS_ROW, AS_ROW),
    "mark": _word("beyond_healthy (of legs: beyond error and healthy_limit), beyond_error, or empty"),
    "healthy_limit": ColumnMeaning("what 95 of 100 healthy people's legs differ by less", AS_PARAMETER, "", AS_ROW),
}
PERCENT = {"percent": ColumnMeaning("of the stride, from initial contact to the next")}


def _of_angles(joint: Joint) -> dict[str, ColumnMeaning]:
    sign = FLEXION[joint.split("_")[1]]
    return {
        f"{joint}_deg": ColumnMeaning("angle: twist of the relative orientation about the joint's axis", HEIGHT, sign),
        f"{joint}_sd_deg": ColumnMeaning("standard deviation of the angle, estimated"),
        f"{joint}_published_deg": ColumnMeaning(
            "angle by the published filter, on the same identification", HEIGHT, sign
        ),
        f"{joint}_orientation_deg": ColumnMeaning("angle from the two sensors' orientations", HEIGHT, sign),
        f"{joint}_status": ANGLE_STATUS,
    }


def _of_hip(joint: Joint) -> dict[str, ColumnMeaning]:
    """Columns of a hip, which has no axis and no published filter."""
    return {
        f"{joint}_deg": ColumnMeaning("flexion of the thigh in the pelvis, from standing", HEIGHT, "flexion positive"),
        f"{joint}_sd_deg": ColumnMeaning("standard deviation of the flexion, estimated"),
        f"{joint}_abduction_deg": ColumnMeaning(
            "abduction from standing; empty where the heading between pelvis and thigh is not sure enough",
            HEIGHT,
            "abduction positive",
        ),
        f"{joint}_status": ANGLE_STATUS,
    }


OF_PELVIS = {
    "pelvis_tilt_deg": ColumnMeaning("tilt against the vertical, from standing", "zero", "forward positive"),
    "pelvis_obliquity_deg": ColumnMeaning("obliquity against the vertical, from standing", "zero", "left up positive"),
    "pelvis_rotation_deg": ColumnMeaning(
        "heading against its mean over two strides; empty in turns", sign="to the left positive"
    ),
}


def _of_cycles(joint: Joint) -> dict[str, ColumnMeaning]:
    sign = FLEXION[joint.split("_")[1]]
    return {
        f"{joint}_mean_deg": ColumnMeaning("mean angle over the strides used", HEIGHT, sign),
        f"{joint}_stride_sd_deg": ColumnMeaning("standard deviation between the strides used"),
        f"{joint}_n": N,
        f"{joint}_shape_deg": ColumnMeaning("mean angle over the strides used, less its mean", "sign", sign),
        f"{joint}_status": ANGLE_STATUS,
    }


def _prefixed(prefix: str, columns: Mapping[str, ColumnMeaning], whose: str) -> dict[str, ColumnMeaning]:
    return {prefix + name: one._replace(definition=f"{one.definition}{whose}") for name, one in columns.items()}


def _of_abduction(joint: Joint) -> dict[str, ColumnMeaning]:
    sign = "abduction positive"
    return {
        f"{joint}_abduction_mean_deg": ColumnMeaning(
            "mean abduction over the strides used; empty where the heading between pelvis and thigh is not sure enough",
            HEIGHT,
            sign,
        ),
        f"{joint}_abduction_stride_sd_deg": ColumnMeaning("standard deviation between the strides used"),
        f"{joint}_abduction_n": N,
        f"{joint}_abduction_status": _word(f"{STATUS}the abduction"),
    }


CYCLES = (
    PERCENT
    | {name: column for joint in Joint for name, column in _of_cycles(joint).items()}
    | {name: column for side in Side for name, column in _of_abduction(hip_of(side)).items()}
)
DIFFERENCES = {
    **OF_PART,
    **_prefixed("against_", {**OF_PART, **MEAN, **BY_HAND}, ", of what it is compared with"),
    "side": _word("left, right or both"),
    "parameter": PARAMETER,
    **MEAN,
    **JUDGED,
    **BY_HAND,
    "chosen_before": _word("true where a goal of the parameter had been agreed before the session's day"),
    **LIKELY,
}
KNOWN: Mapping[str, Mapping[str, ColumnMeaning]] = {
    "angles.csv": {
        "time_s": ON_CLOCK,
        **{name: column for joint in LEG_JOINTS for name, column in _of_angles(joint).items()},
        **{name: column for side in Side for name, column in _of_hip(hip_of(side)).items()},
        **OF_PELVIS,
        **{f"{side}_phase": _word("loading, foot_flat, pre_swing or swing; empty: not known") for side in Side},
    },
    "events.csv": {
        "time_s": ON_CLOCK,
        "side": SIDE,
        "event": _word("initial_contact, full_contact, heel_rise or toe_off"),
    },
    "strides.csv": {
        "side": SIDE,
        **TIMES,
        **{name: _of_stride(name) for name in PARAMETERS},
        "used": USED,
        "reason": _word("why the stride does not count; empty where it does"),
        "timing_status": _word(f"{STATUS}stride time, stance and swing"),
        "between_status": _word(f"{STATUS}step time"),
        "distance_status": _word(f"{STATUS}stride length, speed and clearance"),
        **{f"{kind}_shape_status": _word(f"{STATUS}the {kind}'s range") for kind in FLEXION},
        **{f"{kind}_height_status": _word(f"{STATUS}the {kind}'s angles") for kind in FLEXION},
        **{name: _of_pelvis(name) for name in OF_HIPS},
        "hip_abduction_status": _word(f"{STATUS}how far the hip moves outwards and inwards"),
        "pelvis_status": _word(f"{STATUS}the pelvis"),
        "pelvis_tilt_status": _word(f"{STATUS}the range of the pelvis's tilt"),
    },
    "cycles.csv": CYCLES,
    "peaks.csv": {
        "recording": _word("its folder"),
        "side": SIDE,
        "start_s": TIMES["start_s"],
        "used": USED,
        **{
            f"{window.name}_percent": ColumnMeaning(
                f"when the extremum from {window.first} to {window.last} % comes", "sign"
            )
            for window in WINDOWS.values()
        },
        **{name: _of_stride(name) for name in EXCURSIONS_BY_COLUMN},
        "hip_flexion_peak_percent": ColumnMeaning("when the largest hip flexion of the stride comes", "sign"),
        "hip_extension_peak_percent": ColumnMeaning("when the largest hip extension of the stride comes", "sign"),
        **{f"{kind}_status": _word(f"{STATUS}when the {kind} peaks, and its excursions") for kind in FLEXION},
    },
    "fitting.csv": {
        "side": SIDE,
        "start_s": TIMES["start_s"],
        **{name: _of_fitting(name) for name in FITTING},
        "used": USED,
        "knee_height_status": _word(f"{STATUS}how straight the knee becomes"),
        "knee_timing_status": _word(f"{STATUS}when the knee is straight"),
        "foot_timing_status": _word(f"{STATUS}how long the foot is flat"),
        "foot_pitch_status": _word(f"{STATUS}the pitch of the foot"),
        "segment_turn_status": _word(f"{STATUS}by how much the shank turns"),
        "segment_inclination_status": _word(f"{STATUS}how thigh and shank lean"),
    },
    "fitting_means.csv": {
        "recording": _word("its folder"),
        "side": SIDE,
        "measure": _word("the column of fitting.csv, strides.csv or peaks.csv"),
        **MEAN,
        "error": ColumnMeaning(
            "half of what two means as sure, of walks with the sensors left on, have to differ by",
            AS_PARAMETER,
            "",
            AS_ROW,
        ),
        "unverified": _word("true where definition or error rests on a source that could not be read"),
        "status": _word(f"{STATUS}the measure"),
        "source": _word("where the measure comes from"),
        "cannot_say": _word("what the measure does not show"),
    },
    "sides.csv": {
        **OF_PART,
        "parameter": PARAMETER,
        **{name: one for side in Side for name, one in _prefixed(f"{side}_", {**MEAN, **BY_HAND}, "").items()},
        **JUDGED,
        "symmetry_index_percent": ColumnMeaning("difference by the mean of both legs", AS_PARAMETER),
        **LIKELY,
    },
    "goals.csv": {
        "recording": _word("its folder"),
        "condition": _word("what was worn or set"),
        "measure": _word("the column of strides.csv or peaks.csv, or the figure of both legs, that the goal is of"),
        "side": _word("left, right, both (of the walk), or between (how far the legs are apart)"),
        "limit": _word("at_least or at_most"),
        "goal": ColumnMeaning("the value that was agreed", unit=AS_ROW),
        "unit": _word("of goal, value and error"),
        "agreed": _word("the day on which it was typed"),
        "until": _word("the day by which it is to be reached, where one was named"),
        "agreed_before": _word("true where it was agreed before the session's day: only then its standing is judged"),
        "value": ColumnMeaning(
            "mean over the strides used; between the legs, left less right", AS_PARAMETER, AS_ROW, AS_ROW
        ),
        "error": ColumnMeaning(
            "what a difference has to exceed to be real, between visits, or between the legs", AS_PARAMETER, "", AS_ROW
        ),
        "status": _word(f"{STATUS}the value"),
        "standing": _word(
            "reached or short (by more than the error), reached_inside_error or short_inside_error (not distinguished "
            "from the goal), not_judged or unknown"
        ),
    },
    "targets.csv": {
        "recording": _word("its folder"),
        "condition": _word("what was worn or set"),
        "measure": _word("what the patient aimed at on a screen of their own, stride by stride, as it was shown live"),
        "side": _word("left or right; empty of both legs"),
        "target": _word("the value to be reached, in the unit beside it"),
        "unit": _word("of the target"),
        "reached": _word("values that, rounded to a whole number, reached the target"),
        "strides": _word("values that were shown"),
        "reached_percent": ColumnMeaning("share of the values shown that reached the target"),
    },
    "timed_test.csv": {
        "recording": _word("its folder"),
        "condition": _word("what was worn or set"),
        "test": _word("which test the walk is, in the words of session.toml"),
        "row": _word(
            "what the row is of: test, third, lap, turn, pause, rise, stair (a stride), silence of a sensor, part (of "
            "an up and go) or sitting; rise_mean, rise_slowest, sitting_mean and sitting_slowest are of several"
        ),
        "number": _word("of the rows of this kind, from 1"),
        "start_s": ColumnMeaning("of a test on the recording's clock, of its parts from the start of the test"),
        "end_s": ColumnMeaning("likewise"),
        "time_s": ColumnMeaning("from start to end"),
        "distance_m": ColumnMeaning("what counts; distance_source states where it is from"),
        "sensor_distance_m": ColumnMeaning("by the feet's sensors, turns as arcs"),
        "speed_m_s": ColumnMeaning("distance by time, pauses included"),
        "cadence_steps_min": ColumnMeaning("of the median stride, pauses excluded", unit="steps/min"),
        "turn_deg": ColumnMeaning("how far the body turned", sign="positive: to the left"),
        "side": _word("of the foot that went up or down"),
        "climb_m": ColumnMeaning("how much higher the foot came to stand", sign="positive: up"),
        "started_by": _word("key or motion"),
        "ended_by": _word("key or motion"),
        "sensor": _word("the one that was silent"),
        "missing": _word("why cells of the test are empty"),
        "part": _word("of an up and go: rise, walk_out, turn, walk_back, turn_to_sit or sit"),
        "validity": _word("valid, not_valid, or not_checked, where nothing shows the course"),
        "not_valid": _word("in what it was not the test that it is called; its figure is in no mean of attempts"),
        "course_m": ColumnMeaning(
            "from the chair to the cone, between the tapes, or of a lap from turn to turn, as entered or as the test "
            "has it"
        ),
        "course_found_m": ColumnMeaning("the same by the feet"),
        "distance_source": _word(
            "feet; tape (between two marks); typed (laps and the rest, as entered); found_laps (laps of the length "
            "entered, as many as the turns show)"
        ),
    },
    "alignments.csv": {
        "walk": _word("the recording before which it was changed"),
        "condition": _word("what the walk is called"),
        "since": _word("the condition that it was changed from"),
        "part": _word("foot, socket, knee unit or pylon, and which screw"),
        "angle_deg": ColumnMeaning(
            "by how much the part was tilted or turned, as somebody typed it",
            sign="positive: plantarflexion or eversion of the foot, toes out, flexion or abduction of the socket",
        ),
        "turns": ColumnMeaning("turns of the screw", sign="positive: out", unit="turns"),
        "shift_mm": ColumnMeaning("shift of the part", sign="positive: back; of inner and outer screws outwards"),
        "height_mm": ColumnMeaning("height of the part", sign="positive: longer or higher"),
        "text": _word("what somebody has typed of it"),
        "in_words": _word("the change in a line"),
    },
    "set_angles.csv": {
        "condition": _word("what the walk is called"),
        "since": _word("the condition that it was changed from, or whose setting it repeats"),
        "side": _word("the prosthetic leg"),
        "set_deg": ColumnMeaning("by how much the foot was set, as somebody typed it", sign="plantarflexion positive"),
        "measured_deg": ColumnMeaning(
            "by how much the foot's angle against the shank in swing changed", "zero sign", "plantarflexion positive"
        ),
        "error_deg": ColumnMeaning("half of the likely interval (95 of 100) of what is measured"),
        "agrees": _word("yes where what was set lies in the interval"),
        "other_changes": _word("yes where something else was changed, of which nothing is measured"),
    },
    **dict.fromkeys(("differences.csv", "visits.csv"), DIFFERENCES),
    **dict.fromkeys(("compared_cycles.csv", "visits_cycles.csv"), CYCLES),
}
LETTERED = ("compared_cycles.csv", "visits_cycles.csv")  # whose columns begin with the letter of a condition or visit


def column_of(file: str, name: str) -> ColumnMeaning:
    """Give a column's meaning; raises KeyError where no such file has such a column."""
    if file in LETTERED and name not in PERCENT:
        letter, _, rest = name.partition("_")
        return KNOWN[file][rest]._replace(definition=f"{KNOWN[file][rest].definition}, of {letter}")
    return KNOWN[file][name]


def write_columns(folder: Path, recordings: list[str]) -> None:
    """Write the meaning of every column of the tables in `folder` and in its subfolders `recordings`."""
    write_table(HEADER, _rows(folder, recordings), folder / COLUMNS)


def _rows(folder: Path, recordings: list[str]) -> Iterator[tuple[str, ...]]:
    for file in KNOWN:
        places = [folder / file, *(folder / recording / file for recording in recordings)]
        names = dict.fromkeys(name for place in places if place.is_file() for name in names_in(place))
        for name in names:
            column = column_of(file, name)
            yield file, name, unit_of(file, name), column.sign, column.definition, column.needs


def names_in(path: Path) -> list[str]:
    """The columns of a table, as its first line names them."""
    with path.open(encoding="utf-8", newline="") as file:
        return next(csv.reader(file), [])


def unit_of(file: str, name: str) -> str:
    """A column's unit; empty where it holds words or counts. Errors as of `column_of`."""
    unit = column_of(file, name).unit
    if unit is None:
        found = parameters.unit_of(name)
        return found.in_files if found is not None else ""
    return unit

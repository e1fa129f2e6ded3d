"""Tests that all outputs doubt the same figures.

One simulated session per cause of doubt, every file read by another program.

What has to be stated is in `STATED`, written by hand. Each output has a function that takes the folder of a case and
gives what it states of the quantities that it reports; `OUTPUTS` lists them. Report and screen are read by their words.
"""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from fnmatch import fnmatch
from pathlib import Path
from typing import Any

import ezc3d
import openpyxl
import pytest
from fhir.resources.R4B.bundle import Bundle
from rerun.chunk import RrdReader

from app.exports.exports import Format, export_from_folder
from app.exports.result_folder import LOG, write_results
from app.reports.patient.document import make_report
from app.results.result_page import ResultPage
from app.review.rerun_log import write_log
from app.summary.request import AnalysedVisit, ReportRequest
from core.body import LEG_SITES, Side, Site
from core.results import Analysis
from core.session import Recording, Session
from devices.simulation.walker import Standing, Walk, WalkerSettings
from devices.simulation.walker_body import GaitChange
from tests.app.doubt_readers import Stated, stated_in_report, stated_on_screen
from tests.app.exports.written_tables import csv_rows
from tests.simulated import analysis_of, session_of

NUMBER = (int, float)
READ, CARE, SHAPE, NOT_REPORTED = "read", "care", "shape", "withheld"
WALK = "walk 1"
SIDES = ("left", "right")
FIGURES = {  # what a person calls it, its column
    "knee range": "knee_range_deg",
    "knee swing peak": "knee_swing_peak_deg",
    "knee peak time": "knee_swing_peak_percent",
    "ankle range": "ankle_range_deg",
    "ankle dorsiflexion": "ankle_stance_dorsiflexion_deg",
    "stance": "stance_percent",
    "stride length": "stride_length_m",
    "step time": "step_time_s",
}
BOTH = {"cadence": "cadence_steps_min", "double support": "double_support_percent", "speed": "speed_m_s"}
OF_SIDES = {f"{side} {name}": (side, column) for side in SIDES for name, column in FIGURES.items()}
CURVES = {f"{side} {kind} curve": f"{side}_{kind}" for side in SIDES for kind in ("knee", "ankle")}
QUANTITIES = (*OF_SIDES, *BOTH, *CURVES)


@dataclass(frozen=True)
class Case:
    """`stated`: what differs from "read", by the quantities' names (* is any); `reason`: words that say why."""

    settings: WalkerSettings
    stated: Mapping[str, str]
    reason: str
    change: Callable[[Session], Session] = lambda session: session

    @property
    def expected(self) -> dict[str, str]:
        found = dict.fromkeys(QUANTITIES, READ)
        for pattern, verdict in self.stated.items():
            hit = [name for name in QUANTITIES if fnmatch(name, pattern)]
            assert hit, pattern
            found |= dict.fromkeys(hit, verdict)
        return found


def with_swapped_shanks(session: Session) -> Session:
    """The shanks' sensors were strapped to the wrong legs."""

    def swapped(one: Recording) -> Recording:
        left, right = one.imu[Site.LEFT_SHANK], one.imu[Site.RIGHT_SHANK]
        return replace(one, imu={**one.imu, Site.LEFT_SHANK: right, Site.RIGHT_SHANK: left})

    return replace(session, recordings=tuple(map(swapped, session.recordings)))


STOOD, WALKED = Standing(), Walk(WALK, strides=16)
STIFF = replace(WALKED, change=GaitChange(knee_deg=-7.0), changed_side=Side.LEFT)  # of 14 deg, so that 7 are left
LATE = {site: 0.1 for site in LEG_SITES if site.side is Side.RIGHT}
CASES = {
    "no standing reference": Case(
        WalkerSettings(seed=4, recordings=(WALKED,)),
        {"* swing peak": NOT_REPORTED, "* dorsiflexion": NOT_REPORTED, "* curve": SHAPE},
        "There is no standing reference, so absolute angles are not reported",
    ),
    "sign unknown": Case(
        WalkerSettings(seed=4, recordings=(STOOD, STIFF), stiff_knee_side=Side.LEFT),
        {"left knee swing peak": NOT_REPORTED, "left knee peak time": NOT_REPORTED, "left knee curve": NOT_REPORTED},
        "Flexion and extension could not be distinguished",
    ),
    "not neighbours": Case(
        WalkerSettings(seed=4, recordings=(STOOD, WALKED)),
        {"* knee *": NOT_REPORTED, "* ankle *": NOT_REPORTED, "* stance": CARE, "* length": CARE, "* step time": CARE}
        | {"cadence": CARE, "speed": CARE, "double support": NOT_REPORTED},
        "Sensor positions could not be confirmed",
        with_swapped_shanks,
    ),
    "two clocks": Case(
        WalkerSettings(seed=4, recordings=(STOOD, WALKED), clock_late_s=LATE),
        {"* step time": NOT_REPORTED},
        "Left and right sensors are not synchronised. The left step takes",
    ),
    "two strides": Case(  # of the right leg; the left made three
        WalkerSettings(seed=4, recordings=(STOOD, replace(WALKED, strides=4))),
        {
            "left *": CARE,
            "right *": NOT_REPORTED,
            "cadence": NOT_REPORTED,
            "double support": NOT_REPORTED,
            "speed": NOT_REPORTED,
        },
        "Few strides (",
    ),
}


@pytest.fixture(scope="module", params=CASES)
def case(request: pytest.FixtureRequest) -> Case:
    return CASES[request.param]


@pytest.fixture(scope="module")
def analysed(case: Case) -> tuple[Session, Analysis]:
    session = case.change(session_of(case.settings))
    return session, analysis_of(session)


FORMATS = [Format.C3D, Format.FHIR, Format.MOT, Format.XLSX]
NOT_WRITTEN = "not_written"  # what the export stated of files that it left out


@pytest.fixture(scope="module")
def out(analysed: tuple[Session, Analysis], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of results of a case, with every format that states figures in it."""
    folder = tmp_path_factory.mktemp("out")
    write_results(*analysed, folder)
    write_log(*analysed, folder / LOG)
    lines = export_from_folder(*analysed, FORMATS, folder, is_identified=True)
    (folder / NOT_WRITTEN).write_text("\n".join(lines), encoding="utf-8")
    return folder


def stated_of_value(status: str, has_value: bool) -> str:
    """What is stated about a figure by its status and by whether there is a number; both have to say the same."""
    is_reported = status in (READ, CARE)
    return status if is_reported == has_value else f"contradicts itself: {status}, {'a' if has_value else 'no'} number"


CSV_STATUS = {  # which column of status a figure is under
    "knee range": "knee_shape_status",
    "knee swing peak": "knee_height_status",
    "ankle range": "ankle_shape_status",
    "ankle dorsiflexion": "ankle_height_status",
    "stance": "timing_status",
    "stride length": "distance_status",
    "step time": "between_status",
}


def in_csv(out: Path) -> dict[str, str]:
    """strides.csv and peaks.csv of figures, angles.csv and cycles.csv of curves."""
    strides, peaks, stated = csv_rows(out / "walk_1" / "strides.csv"), csv_rows(out / "peaks.csv"), {}
    for side in SIDES:
        used = [row for row in strides if row["side"] == side and row["used"] == "true"]
        assert used
        for name, status in CSV_STATUS.items():
            (word,) = {row[status] for row in used}
            stated[f"{side} {name}"] = stated_of_value(word, any(row[FIGURES[name]] for row in used))
        mine = [row for row in peaks if row["side"] == side]
        (word,) = {row["knee_status"] for row in mine}
        stated[f"{side} knee peak time"] = stated_of_value(word, any(row["knee_swing_peak_percent"] for row in mine))
        reported = any(row["knee_swing_peak_percent"] for row in used)
        assert reported == (stated[f"{side} knee peak time"] in (READ, CARE))
    angles, cycles = csv_rows(out / "walk_1" / "angles.csv"), csv_rows(out / "walk_1" / "cycles.csv")
    for name, joint in CURVES.items():
        (status,) = {row[f"{joint}_status"] for row in angles}
        assert status == {row[f"{joint}_status"] for row in cycles}.pop()
        assert any(row[f"{joint}_deg"] for row in angles)  # the samples stay, as evidence
        stated[name] = {"no_zero": SHAPE, "range_only": NOT_REPORTED}.get(status, status)
        has_height, has_shape = (any(row[f"{joint}_{what}"] for row in cycles) for what in ("mean_deg", "shape_deg"))
        assert has_height == (stated[name] in (READ, CARE))
        assert has_shape == (stated[name] != NOT_REPORTED)
    return stated


def in_json(out: Path) -> dict[str, str]:
    """summary.json: means with their status, curves by the verdicts of their joint."""
    walk = json.loads((out / "summary.json").read_text(encoding="utf-8"))["walks"][WALK]
    stated = {
        name: stated_of_value(walk[side][f"{column}_status"], walk[side][f"{column}_mean"] is not None)
        for name, (side, column) in OF_SIDES.items()
    }
    for name, column in BOTH.items():
        stated[name] = stated_of_value(walk["both"][f"{column}_status"], walk["both"][column] is not None)
    for name, joint in CURVES.items():
        verdicts = {part: reported["verdict"] for part, reported in walk["verdicts"][joint].items()}
        stated[name] = curve_by_verdicts(verdicts)
    return stated


def curve_by_verdicts(verdicts: Mapping[str, str]) -> str:
    if NOT_REPORTED in (verdicts["shape"], verdicts["sign"]):
        return NOT_REPORTED
    if verdicts["height"] == NOT_REPORTED:
        return SHAPE
    return CARE if CARE in (verdicts["shape"], verdicts["height"]) else READ


def in_fhir(out: Path) -> dict[str, str]:
    """Final and preliminary Observations, and those with a reason in place of a value."""
    bundle = Bundle.model_validate_json((out / "fhir_bundle.json").read_bytes())
    entries: list[Any] = list(bundle.entry or ())
    stated = {}
    names = {pair: name for name, pair in OF_SIDES.items()} | {("", column): name for name, column in BOTH.items()}
    for one in (entry.resource for entry in entries if entry.resource.get_resource_type() == "Observation"):
        side = one.bodySite.text.removesuffix(" leg") if one.bodySite is not None else ""
        name = names.get((side, one.code.coding[-1].code))
        assert one.interpretation is None
        assert one.referenceRange is None
        if name is None:
            continue
        if one.dataAbsentReason is not None:
            assert one.valueQuantity is None
            assert one.status != "final"
            assert len(one.dataAbsentReason.text) > 20
            code = one.dataAbsentReason.coding[0].code
            stated[name] = {"error": NOT_REPORTED, "not-performed": "not measured"}[code]
        else:
            assert one.valueQuantity.value is not None
            stated[name] = {"final": READ, "preliminary": CARE}[one.status]
    return stated


def in_xlsx(out: Path) -> dict[str, str]:
    """The Summary sheet's numbers, words and status, and the mean cycles."""
    book = openpyxl.load_workbook(out / "gaitwright.xlsx")
    summary = {(row["side"], row["parameter"]): row for row in sheet(book, "Summary")}
    required = OF_SIDES | {name: ("both", column) for name, column in BOTH.items()}
    stated = {}
    for name, key in required.items():
        mean, status = summary[key]["mean"], KEYS[summary[key]["status"]]
        assert isinstance(mean, NUMBER) or mean is None
        stated[name] = stated_of_value(status, isinstance(mean, NUMBER))
    for side, column in OF_SIDES.values():
        cells = [row[column] for row in sheet(book, "Strides") if row["side"] == side and row["used"] == "true"]
        is_not_reported = KEYS[summary[side, column]["status"]] == NOT_REPORTED
        assert all(cell is None for cell in cells) if is_not_reported else any(isinstance(c, NUMBER) for c in cells)
    cycles = sheet(book, "Cycles")
    for name, joint in CURVES.items():
        (status,) = {row[f"{joint}_status"] for row in cycles}
        height, shape = (
            {isinstance(row[f"{joint}_{what}"], NUMBER) for row in cycles} for what in ("mean_deg", "shape_deg")
        )
        by_cells: dict[tuple[object, ...], str] = {
            (True, True): READ,
            (False, True): SHAPE,
            (False, False): NOT_REPORTED,
        }
        stated[name] = by_cells[*height, *shape]
        if stated[name] == READ:
            stated[name] = KEYS[status] if KEYS[status] in (READ, CARE) else "contradicts itself"
    return stated


KEYS = {"Good": READ, "Caution": CARE, "Not reported": NOT_REPORTED, "Not measured": "not_measured"}


def sheet(book: Any, title: str) -> list[dict[str, Any]]:
    header, *rows = book[title].iter_rows(values_only=True)
    return [dict(zip(header, row, strict=True)) for row in rows]


C3D = {"LKneeAngles": "left_knee", "RKneeAngles": "right_knee"} | {
    "LAnkleAngles": "left_ankle",
    "RAnkleAngles": "right_ankle",
}


def in_c3d(out: Path) -> dict[str, str]:
    """The labels of its points, and what PROCESSING:STATUS states of each joint."""
    parameters = ezc3d.c3d(str(out / "walk_1" / "angles.c3d"))["parameters"]
    labels = parameters["POINT"]["LABELS"]["value"]
    status = dict(text.split(": ", 1) for text in parameters["PROCESSING"]["STATUS"]["value"])
    stated = {}
    for name, joint in CURVES.items():
        label = next(label for label, of in C3D.items() if of == joint)
        if f"{label}_SHAPE" in labels:
            stated[name] = SHAPE
        else:
            stated[name] = status[joint].split(":")[0] if label in labels else NOT_REPORTED
    for label, words in zip(labels, parameters["POINT"]["DESCRIPTIONS"]["value"], strict=True):
        assert ("less its mean" in words) == label.endswith("_SHAPE")
        assert "positive" not in words
    return stated


MOT = {"knee_angle_l": "left_knee", "knee_angle_r": "right_knee"} | {
    "ankle_angle_l": "left_ankle",
    "ankle_angle_r": "right_ankle",
}


def in_mot(out: Path) -> dict[str, str]:
    """The coordinates that are there, and the comments on them. A shape is no pose, so it is left out.

    Where none is left there is no file, and the export states why.
    """
    if not (out / "walk_1" / "angles.mot").exists():
        return dict.fromkeys(
            CURVES,
            SHAPE
            if "There is no standing reference, so absolute angles are not reported" in words_of_mot(out)
            else NOT_REPORTED,
        )
    head, body = (out / "walk_1" / "angles.mot").read_text(encoding="ascii").split("endheader\n")
    names = body.splitlines()[0].split("\t")
    comments = dict(line.split(" is ", 1) for line in head.splitlines() if line.split(" is ")[0] in MOT)
    stated = {}
    for name, joint in CURVES.items():
        coordinate = next(coordinate for coordinate, of in MOT.items() if of == joint)
        where, status = comments[coordinate].split(":")[0].split(", ")
        assert (where == "here") == (coordinate in names)
        assert where in ("here", "left out")
        stated[name] = status if coordinate in names else SHAPE if status == "no_zero" else NOT_REPORTED
    return stated


def in_rerun(out: Path) -> dict[str, str]:
    """Where the curves lie, and the table of what may be read."""
    chunks = list(RrdReader(out / "session.rrd").stream())
    moving = {chunk.entity_path for chunk in chunks if "walking_1" in chunk.timeline_names}
    (document,) = [chunk.to_record_batch().to_pydict() for chunk in chunks if chunk.entity_path == "/may_be_read"]
    table = [
        [cell.strip() for cell in line.strip("|").split("|")]
        for line in document["TextDocument:text"][0][0].split("## walking_1")[1].splitlines()
        if line.startswith("| ")
    ]
    verdicts = {(row[0], row[1]): row[2] for row in table}
    stated = {}
    for name, joint in CURVES.items():
        by_place = {
            f"/angles/{joint}/result": READ,
            f"/angles/{joint}/result_shape": SHAPE,
            f"/withheld/{joint}/result": NOT_REPORTED,
        }
        (place,) = moving & by_place.keys()
        words = joint.replace("_", " ")
        by_table = curve_by_verdicts({part: verdicts[words, part] for part in ("shape", "height", "sign")})
        stated[name] = by_table if by_place[place] == (READ if by_table == CARE else by_table) else "contradicts itself"
    for side in SIDES:
        stated[f"{side} stance"] = verdicts[f"{side} leg", "timing"]
        stated[f"{side} stride length"] = verdicts[f"{side} leg", "distance"]
        stated[f"{side} knee range"] = verdicts[f"{side} knee", "shape"]
        stated[f"{side} ankle range"] = verdicts[f"{side} ankle", "shape"]
    return stated


RERUN = tuple(name for name in QUANTITIES if name.endswith(("curve", "stance", "length", "range")))
# what each output reports
OUTPUTS: dict[str, tuple[Callable[[Path], dict[str, str]], tuple[str, ...]]] = {
    "csv": (in_csv, (*OF_SIDES, *CURVES)),
    "json": (in_json, QUANTITIES),
    "fhir": (in_fhir, (*OF_SIDES, *BOTH)),
    "xlsx": (in_xlsx, QUANTITIES),
    "c3d": (in_c3d, tuple(CURVES)),
    "mot": (in_mot, tuple(CURVES)),
    "rerun": (in_rerun, RERUN),
}


@pytest.mark.parametrize("output", OUTPUTS)
def test_every_output_states_the_same(case: Case, out: Path, output: str) -> None:
    read, shows_of = OUTPUTS[output]
    assert read(out) == {name: case.expected[name] for name in shows_of}


SPOKEN = {READ: Stated.REPORTED, CARE: Stated.CARE, NOT_REPORTED: Stated.NOT_REPORTED}


def test_report_and_screen_say_the_same(
    case: Case, analysed: tuple[Session, Analysis], result_page: ResultPage
) -> None:
    session, analysis = analysed
    made_at = datetime(2026, 11, 22, 12, tzinfo=UTC)
    report = stated_in_report(make_report(ReportRequest(AnalysedVisit(session, analysis), (WALK,), made_at, "1.2.3")))
    result_page.show_visit(AnalysedVisit(session, analysis))
    screen = stated_on_screen(result_page)
    places = {name: (Side(side), column) for name, (side, column) in OF_SIDES.items()}
    places |= {name: (Side.LEFT, column) for name, column in BOTH.items()}
    for found in (report, screen):
        reported = {name: found[place] for name, place in places.items() if place in found}
        assert len(reported) > 10
        assert reported == {name: SPOKEN[case.expected[name]] for name in reported}


def words_of_about(out: Path) -> str:
    rows = openpyxl.load_workbook(out / "gaitwright.xlsx").worksheets[0].iter_rows(values_only=True)
    return "\n".join(str(row[1]) for row in rows)


def words_of_mot(out: Path) -> str:
    path = out / "walk_1" / "angles.mot"
    if path.exists():
        return path.read_text(encoding="ascii")
    lines = (out / NOT_WRITTEN).read_text(encoding="utf-8").splitlines()
    (line,) = (
        line for line in lines if line.startswith(f"{WALK}, mot: This recording has no angle to export as a pose.")
    )
    return line


def words_of_c3d(out: Path) -> str:
    parameters = ezc3d.c3d(str(out / "walk_1" / "angles.c3d"))["parameters"]
    return "\n".join(parameters["PROCESSING"]["STATUS"]["value"])


def words_of_rerun(out: Path) -> str:
    return "".join(
        str(chunk.to_record_batch().to_pydict())
        for chunk in RrdReader(out / "session.rrd").stream()
        if chunk.entity_path == "/may_be_read"
    )


REASONS: dict[str, Callable[[Path], str]] = {
    "json": lambda out: (out / "summary.json").read_text(encoding="utf-8"),
    "fhir": lambda out: (out / "fhir_bundle.json").read_text(encoding="utf-8"),
    "xlsx": words_of_about,
    "rerun": words_of_rerun,
    "c3d": words_of_c3d,
    "mot": words_of_mot,
}
ANGLES_ONLY = ("c3d", "mot")  # which report of no time


@pytest.mark.parametrize("output", REASONS)
def test_every_output_gives_the_reason(case: Case, out: Path, output: str) -> None:
    is_of_angles = any(verdict != READ for name, verdict in case.expected.items() if name in CURVES)
    assert (case.reason in REASONS[output](out)) == (is_of_angles or output not in ANGLES_ONLY)

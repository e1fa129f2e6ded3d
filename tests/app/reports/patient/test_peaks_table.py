"""Tests of the table of peaks. Each movement is reported beside the heights, and nothing of one without extremes."""

from dataclasses import replace

import numpy as np
import pytest

from app.reports.patient.peaks_table import peaks_table
from app.summary.facts import Facts
from app.summary.request import AnalysedVisit, ReportRequest
from core.body import Joint, Side
from core.results import Analysis
from core.verdicts.gates import judged
from tests.app.changed_analysis import recalibrated, walk_of

MOVEMENTS = ["Flexion, stance to swing", "Flexion, loading response", "Extension, mid-stance", "Range of motion"]
TIME = "Time of peak flexion in swing, %"
MOVEMENTS_OF_ANKLE = [
    "Plantarflexion, push-off",
    "Dorsiflexion, stance",
    "Plantarflexion, loading response",
    "Dorsiflexion, swing",
    "Range of motion",
]


def groups(request: ReportRequest, analysis: Analysis) -> dict[str, dict[str, list[str]]]:
    """The table's rows by their names, under the heads of their groups."""
    blocks = peaks_table(Facts(AnalysedVisit(request.visit.session, analysis), walk_of(analysis)))
    (table,) = (block for block in blocks if block["kind"] == "table")
    rows, head = table["rows"], ""
    found: dict[str, dict[str, list[str]]] = {}
    assert isinstance(rows, list)
    for row in rows:
        if "group" in row:
            head = row["group"]
            found[head] = {}
        else:
            name, *cells = (cell["said"] for cell in row["cells"])
            found[head][name] = cells
    return found


def test_movements_stand_before_the_angles_of_each_joint(demo: ReportRequest) -> None:
    analysis = demo.visit.analysis
    found = groups(demo, analysis)
    heads = list(found)
    assert heads[1].startswith("Knee: absolute angles (flexion +); whole curve vs reference: L")
    assert heads[::2] == ["Knee: movement ranges", "Ankle: movement ranges"]
    assert list(found["Knee: movement ranges"]) == [*MOVEMENTS, TIME]
    assert list(found["Ankle: movement ranges"]) == MOVEMENTS_OF_ANKLE
    left, right, difference, likely, *_ = found["Ankle: movement ranges"]["Plantarflexion, push-off"]
    gait = walk_of(analysis).gait
    means = [np.rad2deg(gait[s].parameters["ankle_push_off_rad"][gait[s].strides.is_used]).mean() for s in Side]
    assert [left.split(" ± ")[0], right.split(" ± ")[0]] == [f"{mean:.1f}" for mean in means]
    assert difference.replace("\u2212", "-") == f"{means[0] - means[1]:+.1f}"
    low, high = (int(one.replace("\u2212", "-")) for one in likely.split(" to "))  # 7.7°, healthy legs', and chance
    assert (high - low) / 2 == pytest.approx(7.8, abs=0.6)


def test_a_movement_without_extremes_is_a_dash_and_its_peak_is_named(demo: ReportRequest) -> None:
    analysis = demo.visit.analysis
    recordings = []
    for one in analysis.recordings:
        gait = dict(one.gait)
        if Side.LEFT in gait:
            gone = {"knee_while_loading_rad", "knee_straightening_rad", "knee_loading_peak_rad"}
            parameters = gait[Side.LEFT].parameters
            flat = {
                name: np.full_like(values, np.nan) if name in gone else values for name, values in parameters.items()
            }
            gait[Side.LEFT] = replace(gait[Side.LEFT], parameters=flat)
        recordings.append(replace(one, gait=gait))
    found = groups(demo, judged(replace(analysis, recordings=tuple(recordings))))
    knee = found["Knee: movement ranges"]
    assert knee["Flexion, loading response"][0] == knee["Flexion, loading response"][2] == "–"
    assert knee["Flexion, stance to swing"][0] != "–"
    heights = next(rows for head, rows in found.items() if head.startswith("Knee: absolute angles (flexion +)"))
    assert heights["Peak flexion, loading (5–30\u00a0%)"][0] == "no peak"


def test_without_a_sign_the_range_alone_is_reported(demo: ReportRequest) -> None:
    analysis = demo.visit.analysis
    unsure = recalibrated(analysis, [Joint.LEFT_KNEE], is_sign_certain=False, clinical_sign_margin=0.1)
    knee = groups(demo, unsure)["Knee: movement ranges"]
    assert [knee[name][0] for name in MOVEMENTS[:3]] == ["not reported"] * 3
    assert "±" in knee["Range of motion"][0]

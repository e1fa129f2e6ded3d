"""Tests that fitting.csv, fitting_means.csv and the summary hold the measures for fitting.

They hold nothing of what is not reported.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.exports.fitting_csv import fitting_means, fitting_of_side, write_fitting_strides
from app.summary.measures import Measure
from core.body import Joint, Side
from core.results import RecordingAnalysis
from core.verdicts.model import Assessment, LegVerdicts, Verdict
from core.verdicts.quantities import FITTING
from tests.app.exports.written_tables import csv_rows
from tests.simulated import SHORT_VISIT, analysis_of, simulation_of

BAD = Assessment(Verdict.NOT_REPORTED)


@pytest.fixture(scope="module")
def walk() -> RecordingAnalysis:
    made = simulation_of(SHORT_VISIT)
    return analysis_of(made.session).recordings[-1]


def strides_in(walk: RecordingAnalysis, folder: Path) -> list[dict[str, str]]:
    write_fitting_strides(walk, folder)
    return csv_rows(folder / "fitting.csv")


def means_of(walk: RecordingAnalysis) -> dict[tuple[str, str], dict[str, str]]:
    header, rows = fitting_means([walk])
    reported = [dict(zip(header, row, strict=True)) for row in rows]
    assert len(reported) == len({(row["side"], row["measure"]) for row in reported})
    return {(row["side"], row["measure"]): row for row in reported}


def test_a_mean_is_that_of_the_strides_used_in_every_file(walk: RecordingAnalysis, tmp_path: Path) -> None:
    rows, means = strides_in(walk, tmp_path), means_of(walk)
    for side in Side:
        mine = [row for row in rows if row["side"] == side and row["used"] == "true"]
        summary = fitting_of_side(walk, side)
        assert len(mine) >= 3
        for name in FITTING:
            expected = np.mean([float(row[name]) for row in mine])
            assert float(means[side, name]["mean"]) == pytest.approx(expected, abs=1e-4), name
            assert summary[name]["mean"] == pytest.approx(expected, abs=1e-4), name
            assert int(means[side, name]["n"]) == summary[name]["n"] == len(mine)


def test_what_is_not_reported_is_empty_in_every_file_and_the_other_leg_is_not(
    walk: RecordingAnalysis, tmp_path: Path
) -> None:
    knee = replace(walk.verdicts.joint(Joint.LEFT_KNEE), height=BAD)
    leg = LegVerdicts(walk.verdicts.leg(Side.LEFT).timing, BAD)
    doubted = replace(
        walk.verdicts,
        joints={**walk.verdicts.joints, Joint.LEFT_KNEE: knee},
        legs={**walk.verdicts.legs, Side.LEFT: leg},
    )
    walk = replace(walk, verdicts=doubted)
    rows, means = strides_in(walk, tmp_path), means_of(walk)
    not_reported = {name for name in FITTING if "_at_" in name} | {"foot_heel_rise_deg", "knee_terminal_extension_deg"}
    not_reported |= {"shank_to_foot_in_swing_deg"}
    for name in FITTING:
        for side in Side:
            is_empty = side is Side.LEFT and name in not_reported
            used = [row for row in rows if row["side"] == side and row["used"] == "true"]
            assert all((row[name] == "") is is_empty for row in used), (name, side)
            assert (means[side, name]["mean"] == "") is is_empty
            assert (means[side, name]["status"] == "withheld") is is_empty
            assert (fitting_of_side(walk, side)[name]["mean"] is None) is is_empty
    by_side = {row["side"]: row for row in rows}
    assert by_side["left"]["segment_inclination_status"] == by_side["left"]["foot_pitch_status"] == "withheld"
    assert by_side["right"]["segment_inclination_status"] != "withheld"
    assert by_side["left"]["segment_turn_status"] != "withheld"


def test_what_rests_on_a_source_that_was_not_read_states_so(walk: RecordingAnalysis) -> None:
    means = means_of(walk)
    assert means["left", "shank_at_mid_stance_deg"]["unverified"] == "true"
    assert means["left", "stride_length_m"]["unverified"] == "false"  # ours, measured on walks of our own
    assert "relative to" not in means["left", "shank_at_mid_stance_deg"]["source"]
    assert all(row["cannot_say"] for row in means.values())


def test_an_inclination_is_compared_only_between_zeros_of_one_kind_and_a_turn_whatever_they_are() -> None:
    assert Measure("shank_at_mid_stance_deg").needs_height
    assert not Measure("shank_over_flat_foot_deg").needs_height

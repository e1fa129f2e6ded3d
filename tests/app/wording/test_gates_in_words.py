"""Tests that every reason for doubt is stated in words for a clinician.

Each has what was found, what was required and their unit.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from app.wording.verdicts import WITHOUT_FIGURES, WORDS, gate_sentence, gate_words, verdict_alone, verdict_word
from core.body import Joint, Side, Site
from core.gait.clocks import ClockTie
from core.results import AxisHalves, RecordingAnalysis, ZeroKind
from core.signal.reception import Reception
from core.verdicts.gates import verdicts_of
from core.verdicts.model import GateReason, Verdict, Verdicts
from tests.core.verdicts.built_walk import SURE_CLOCKS, calibrations, leg, walk, with_gaps

GROWING = np.linspace(0.0, 1.0, 12)  # over a walk of twelve strides


def reasons_of(found: Verdicts) -> Iterator[GateReason]:
    for joint in found.joints.values():
        for part in (joint.shape, joint.height, joint.sign):
            yield from part.reasons
    for of_leg in found.legs.values():
        yield from (*of_leg.timing.reasons, *of_leg.distance.reasons)
    yield from found.between.reasons


def stated(recording: RecordingAnalysis, *, stiff: tuple[Side, ...] = (), **knee: Any) -> set[str]:
    """Every sentence that is stated about a walk, whose left knee may be calibrated otherwise."""
    reported = calibrations(Joint.LEFT_KNEE, **knee)
    return {
        gate_sentence(reason).replace("\N{NO-BREAK SPACE}", " ")
        for reason in reasons_of(verdicts_of(recording, reported, stiff))
    }


def left(**changes: Any) -> RecordingAnalysis:
    return walk(left=leg(Side.LEFT, **changes))


def clocks(**changes: Any) -> RecordingAnalysis:
    return walk(clocks=replace(SURE_CLOCKS, **changes))


def apart(deg: float, *, is_free_motion: bool = False) -> RecordingAnalysis:
    return walk(axis_halves={Joint.LEFT_ANKLE: AxisHalves(np.deg2rad(deg), 0.01, is_free_motion, {})})


ONE = "Use one receiver for all sensors."
CASES: list[tuple[RecordingAnalysis, dict[str, Any], str]] = [
    (
        walk(),
        {"sign_margin": 1.2},
        "Sensor positions could not be confirmed (clarity 1.20, required 1.50). Check the sensor positions, or",
    ),
    (
        walk(),
        {"is_same_joint": False},
        "Sensor positions could not be confirmed. Check the sensor positions, or record free motion.",
    ),
    (
        walk(),
        {"is_same_joint": False, "sign_margin": 1.89, "disagreement": 0.26},
        (
            "The two sensors do not move like the two sides of one joint (disagreement 0.26, limit 0.20). Check the "
            "sensor positions, or"
        ),
    ),
    (
        walk(doubted_sites=frozenset({Site.LEFT_SHANK, Site.LEFT_FOOT})),
        {},
        "L shank and L foot look swapped: another order fits the movement better. Check the sensor positions.",
    ),
    (
        walk(),
        {"axis_sd_rad": np.deg2rad(7.0)},
        "The calibration has an uncertainty of ±7.0° (limit ±6.5°). Record free motion, or let the patient move",
    ),
    (
        walk(),
        {"axis_sd_rad": np.deg2rad(12.0)},
        "The calibration has an uncertainty of ±12.0° (limit ±9.0°). Record free motion, or let the patient move",
    ),
    (walk(), {"axis_sd_rad": None}, "The uncertainty of the joint axis is not known. Record free motion."),
    (apart(12.0), {}, "The left ankle's axis came out 12.0° apart in the two halves of the walk (limit 10.0°). Record"),
    (
        apart(55.0),
        {},
        "The left ankle's axis came out 55.0° apart in the two halves of the walk, so its angles are not",
    ),
    (
        apart(30.0, is_free_motion=True),
        {},
        "The left ankle's axis came out 30.0° apart in free motion and in the walk (limit 24.0°). Tighten the strap",
    ),
    (
        apart(40.0, is_free_motion=True),
        {},
        "The left ankle's axis came out 40.0° apart in free motion and in the walk, so its angles are not compared.",
    ),
    (
        walk(),
        {"lag_sd_s": 0.004},
        "The two sensors are synchronised only to ±4.0 ms (limit ±2.0 ms). Use one receiver for all sensors.",
    ),
    (
        walk(),
        {"lag_sd_s": 0.02},
        "The two sensors are synchronised only to ±20.0 ms (limit ±10.0 ms). Use one receiver for all sensors.",
    ),
    (
        walk(),
        {"is_lag_at_border": True},
        "The two sensors could not be synchronised from the movement. Use one receiver for all sensors.",
    ),
    (
        walk(),
        {"is_sign_certain": False, "clinical_sign_margin": 0.1},
        "Flexion and extension could not be distinguished (clarity 0.10, required 0.50). Only range of motion is",
    ),
    (
        walk(),
        {"is_sign_certain": False},
        "Flexion and extension could not be distinguished. Only range of motion is reported. Check the curve,",
    ),
    (
        walk(),
        {"zero": ZeroKind.NONE},
        "There is no standing reference, so absolute angles are not reported. Let the patient stand still for",
    ),
    (
        left(knee_range_deg=4.0),
        {},
        "Range of motion is 4.0° (limit 5.0°). Check the curve and the sensors.",
    ),
    (
        left(knee_range_deg=91.0),
        {},
        "Range of motion is 91.0° (limit 90.0°). Check the curve and the sensors.",
    ),
    (
        left(ankle_range_deg=2.0),
        {},
        "Range of motion is 2.0° (limit 3.0°). Check the curve and the sensors.",
    ),
    (
        left(knee_least_deg=-25.0),
        {},
        "The absolute angle reaches -25.0° (limit -20.0°). Record the standing reference again.",
    ),
    (
        left(ankle_least_deg=20.0),
        {},
        "The absolute angle reaches 45.0° (limit 40.0°). Record the standing reference again.",
    ),
    (
        walk(slipped_from_s={Side.LEFT: 12.5}),
        {},
        "Strap moved; strides from 12.5 s on are excluded. Tighten the strap and record free motion again.",
    ),
    (
        walk(left=leg(Side.LEFT, 12, left_out=12), slipped_from_s={Side.LEFT: 0.0}),
        {},
        "Strap moved before this walk. Tighten the strap and record free motion again.",
    ),
    (walk(left=leg(Side.LEFT, 5)), {}, "Few strides (5 used, 10 required). Let the patient walk longer."),
    (walk(left=leg(Side.LEFT, 2)), {}, "Few strides (2 used, 3 required). Let the patient walk longer."),
    (
        left(knee_range_deg=60.0 + 5.0 * (GROWING > 0.5)),
        {},
        "The values in the first and second half of the walk differ by 5.0° (limit 2.0°).",
    ),
    (
        left(stance_percent=60.0 + 2.0 * (GROWING > 0.5)),
        {},
        "The values in the first and second half of the walk differ by 2.0 % (limit 1.5 %).",
    ),
    (
        left(knee_range_deg=60.0 + 6.0 * GROWING),
        {},
        "The values in the first and last third of the walk differ by 4.4° (limit 3.0°).",
    ),
    (
        left(time_s=1.1 * (1.0 + 0.1 * (GROWING > 0.5))),
        {},
        "Stride time differs by 9.5 % between the halves of the walk (limit 4.0 %).",
    ),
    (
        left(stance_percent=60.0 + np.tile([0.5, -0.5], 6) + 0.2 * GROWING),
        {},
        "Every second stride differs from the others by 25.0",
    ),
    (
        walk(received={Site.LEFT_FOOT: with_gaps(2.0)}),
        {},
        "Signal gaps over 50 ms take up 2.0 % of the strides used (1.0 % at most). Move the receiver",
    ),
    (
        walk(received={Site.LEFT_FOOT: with_gaps(6.0)}),
        {},
        "Signal gaps over 50 ms take up 6.0 % of the strides used (5.0 % at most). Move the receiver",
    ),
    (
        walk(received={Site.LEFT_FOOT: Reception(clipped_forces_s=np.array([12.0]))}),
        {},
        "The motion exceeded a sensor's range in 8.3 % of the strides used (0.0 % at most). Choose a wider",
    ),
    (
        walk(received={Site.LEFT_SHANK: Reception(rate_percent=95.0)}),
        {},
        "A sensor sent samples at 95.0 % of the set sample rate (limit 98.0 %). Check the sensor's sample rate",
    ),
    (
        walk(received={Site.LEFT_SHANK: Reception(rate_percent=50.1)}),
        {},
        (
            "Every second sample of a sensor is missing: 50.1 % of the samples arrived (limit 90.0 %). Check the "
            "sensor's sample rate, move"
        ),
    ),
    (left(stance_percent=39.0), {}, "Stance is 39.0 % of the gait cycle (limit 40.0 %). Gait events may be wrong."),
    (left(stance_percent=86.0), {}, "Stance is 86.0 % of the gait cycle (limit 85.0 %). Gait events may be wrong."),
    (
        left(is_toe_off_biased=True),
        {},
        "A prosthetic foot rolls on, so toe-off is detected late. Stance is not compared or judged.",
    ),
    (left(length_m=1.4), {}, "Left and right stride length differ by 7.4 % (limit 5.0 %)."),
    (left(length_m=3.3), {}, "Walking speed is 3.00 m/s (limit 2.50 m/s). Distance may be wrong."),
    (left(length_m=0.055), {}, "Walking speed is 0.05 m/s (limit 0.10 m/s). Distance may be wrong."),
    (
        clocks(tie=ClockTie.UNKNOWN, residual_s=float("nan")),
        {},
        (
            "Left and right sensors are not synchronised. Times that involve both legs are not reported. Use one "
            "receiver"
        ),
    ),
    (
        clocks(residual_s=0.010),
        {},
        "Left and right sensors may be 10.0 ms out of sync (limit 5.0 ms). Use one receiver for all sensors.",
    ),
    (
        clocks(lag_s=0.030),
        {},
        "Left and right sensors may be 30.0 ms out of sync (limit 5.0 ms). Use one receiver for all sensors.",
    ),
    (
        clocks(step_share_percent=57.0),
        {},
        "Left and right sensors are not synchronised. The left step takes 57.0 % of the time of both steps (limit",
    ),
    (
        clocks(step_share_percent=42.0),
        {},
        "Left and right sensors are not synchronised. The left step takes 42.0 % of the time of both steps (limit",
    ),
    (
        walk(drifting_percent={Site.LEFT_SHANK: 2.5}),
        {},
        "One sensor's clock runs 2.5 % faster or slower than the others. Use one receiver for all sensors, then",
    ),
]


@pytest.mark.parametrize(("recording", "knee", "expected"), CASES, ids=range(len(CASES)))
def test_a_reason_is_stated_with_its_figures_and_their_unit(
    recording: RecordingAnalysis, knee: dict[str, Any], expected: str
) -> None:
    assert any(expected in one for one in stated(recording, **knee)), stated(recording, **knee)


def test_of_a_sound_walk_nothing_is_stated() -> None:
    assert stated(walk()) == set()


def test_what_a_device_stiffens_is_stated_with_its_unit_too() -> None:
    assert stated(left(knee_range_deg=4.0), stiff=(Side.LEFT,)) == stated(left(knee_range_deg=4.0))


OF_HIPS = {
    *("hip_found", "hip_disagreement", "hip_centre", "hips_apart", "hip_heading", "hip_deep"),
    *("pelvis_tilt", "leg_clock"),
}


def test_every_gate_that_can_close_has_its_words_and_each_has_a_case() -> None:
    """Those of hips and pelvis are stated in `tests/app/reports/test_pelvis_tables.py`."""
    closed = {
        reason.gate
        for recording, knee, _ in CASES
        for reason in reasons_of(verdicts_of(recording, calibrations(Joint.LEFT_KNEE, **knee), ()))
    }
    assert closed == set(WORDS) - OF_HIPS
    assert set(WITHOUT_FIGURES) <= set(WORDS)


def test_a_gate_without_a_figure_states_that_it_is_unknown() -> None:
    for gate, unit in (("axis", "deg"), ("lag", "ms"), ("step_share", "%"), ("clocks", "ms"), ("pairing", "")):
        assert "unknown" not in gate_sentence(GateReason(gate, Verdict.NOT_REPORTED, None, 9.0, unit))
    assert gate_words(GateReason("speed", Verdict.NOT_REPORTED, None, 2.5, "m/s")).why.startswith(
        "Walking speed is unknown"
    )


def test_each_verdict_has_its_word() -> None:
    assert {str(one): verdict_word(one) for one in Verdict} == {
        "read": "good",
        "care": "caution",
        "withheld": "not reported",
        "not_measured": "not measured",
    }


def test_a_verdict_alone_begins_as_a_title_does() -> None:
    assert [verdict_alone(one) for one in Verdict] == ["Good", "Caution", "Not reported", "Not measured"]


def test_swapped_labels_are_named_where_they_are_known() -> None:
    swapped = GateReason("labels", Verdict.NOT_REPORTED, sites=(Site.LEFT_SHANK, Site.RIGHT_THIGH))
    assert gate_words(swapped).why.startswith("L shank and R thigh look swapped")
    assert gate_words(GateReason("labels", Verdict.NOT_REPORTED)).why.startswith("Sensors look swapped")


def test_a_share_is_written_in_percent() -> None:
    why = gate_words(GateReason("hip_disagreement", Verdict.NOT_REPORTED, 0.31, 0.2)).why
    assert why.endswith("(difference 31\N{NO-BREAK SPACE}%, limit 20\N{NO-BREAK SPACE}%).")

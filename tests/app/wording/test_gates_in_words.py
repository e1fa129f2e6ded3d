"""Is every reason for doubt said, with what was found, what was wanted and their unit, in words for a clinician?"""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from app.wording.verdicts import WITHOUT_FIGURES, WORDS, gate_sentence, gate_words, verdict_word
from core.body import Joint, Side, Site
from core.gait.clocks import ClockTie
from core.results import RecordingAnalysis, ZeroKind
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


def said(recording: RecordingAnalysis, *, stiff: tuple[Side, ...] = (), **knee: Any) -> set[str]:
    """Every sentence that is said of a walk, whose left knee may be calibrated otherwise."""
    told = calibrations(Joint.LEFT_KNEE, **knee)
    return {
        gate_sentence(reason).replace("\N{NO-BREAK SPACE}", " ")
        for reason in reasons_of(verdicts_of(recording, told, stiff))
    }


def left(**changes: Any) -> RecordingAnalysis:
    return walk(left=leg(Side.LEFT, **changes))


def clocks(**changes: Any) -> RecordingAnalysis:
    return walk(clocks=replace(SURE_CLOCKS, **changes))


ONE = "Use one receiver for all sensors."
CASES: list[tuple[RecordingAnalysis, dict[str, Any], str]] = [
    (walk(), {"sign_margin": 1.2}, "The two sensors do not move as neighbours (margin 1.20, 1.50 wanted). Check which"),
    (walk(), {"is_same_joint": False}, "The two sensors do not move as neighbours. Check which sensor is where, or"),
    (
        walk(),
        {"is_same_joint": False, "sign_margin": 1.89, "disagreement": 0.26},
        "The two sensors disagree about their joint (disagreement 0.26, limit 0.20). Check which sensor is where, or",
    ),
    (
        walk(doubted_sites=frozenset({Site.LEFT_SHANK, Site.LEFT_FOOT})),
        {},
        "The motion fits better if the sensors were worn in another order. Check which sensor is where.",
    ),
    (walk(), {"axis_sd_rad": np.deg2rad(7.0)}, "The joint's axis is known to 7.0° only (6.5° wanted). Record free"),
    (walk(), {"axis_sd_rad": np.deg2rad(12.0)}, "The joint's axis is known to 12.0° only (9.0° wanted). Record free"),
    (walk(), {"axis_sd_rad": None}, "How sure the joint's axis is, is not known. Record free motion."),
    (
        walk(),
        {"lag_sd_s": 0.004},
        f"How far the two sensors' clocks are apart is known to 4.0 ms only (2.0 ms wanted). {ONE}",
    ),
    (
        walk(),
        {"lag_sd_s": 0.02},
        f"How far the two sensors' clocks are apart is known to 20.0 ms only (10.0 ms wanted). {ONE}",
    ),
    (walk(), {"is_lag_at_border": True}, f"The motion does not show how far the two sensors' clocks are apart. {ONE}"),
    (
        walk(),
        {"is_sign_certain": False, "clinical_sign_margin": 0.1},
        "from extension (margin 0.10, 0.50 wanted), so only the",
    ),
    (
        walk(),
        {"is_sign_certain": False},
        "The motion does not tell flexion from extension, so only the range holds. Look at",
    ),
    (walk(), {"zero": ZeroKind.NONE}, "No zero was set, so heights say nothing. Let the patient stand still for three"),
    (
        left(knee_range_deg=4.0),
        {},
        "The range over the stride is 4.0° (limit 5.0°). Look at the curve and at the sensors.",
    ),
    (
        left(knee_range_deg=91.0),
        {},
        "The range over the stride is 91.0° (limit 90.0°). Look at the curve and at the sensors.",
    ),
    (
        left(ankle_range_deg=2.0),
        {},
        "The range over the stride is 2.0° (limit 3.0°). Look at the curve and at the sensors.",
    ),
    (left(knee_least_deg=-25.0), {}, "The curve reaches -25.0° (limit -20.0°). Set the zero again."),
    (left(ankle_least_deg=20.0), {}, "The curve reaches 45.0° (limit 40.0°). Set the zero again."),
    (
        walk(slipped_from_s={Side.LEFT: 12.5}),
        {},
        "A strap slipped from 12.5 s on; later strides are left out. Tighten it",
    ),
    (
        walk(left=leg(Side.LEFT, 12, left_out=12), slipped_from_s={Side.LEFT: 0.0}),
        {},
        "A strap slipped before this walk. Tighten",
    ),
    (walk(left=leg(Side.LEFT, 5)), {}, "Few strides (5 used, 10 wanted). Let the patient walk longer."),
    (walk(left=leg(Side.LEFT, 2)), {}, "Few strides (2 used, 3 wanted). Let the patient walk longer."),
    (
        left(knee_range_deg=60.0 + 5.0 * (GROWING > 0.5)),
        {},
        "First and second half of the walk differ by 5.0° (limit 2.0°).",
    ),
    (
        left(stance_percent=60.0 + 2.0 * (GROWING > 0.5)),
        {},
        "First and second half of the walk differ by 2.0 % (limit 1.5 %).",
    ),
    (
        left(knee_range_deg=60.0 + 6.0 * GROWING),
        {},
        "First and last third of the walk differ by 4.4° (limit 3.0°).",
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
        "Gaps over 50 ms take 2.0 % of the strides used (1.0 % at most). Move the receiver",
    ),
    (
        walk(received={Site.LEFT_FOOT: with_gaps(6.0)}),
        {},
        "Gaps over 50 ms take 6.0 % of the strides used (5.0 % at most). Move the receiver",
    ),
    (
        walk(received={Site.LEFT_FOOT: Reception(clipped_forces_s=np.array([12.0]))}),
        {},
        "The motion exceeded a sensor's range in 8.3 % of the strides used (0.0 % at most). Choose a wider range",
    ),
    (
        walk(received={Site.LEFT_SHANK: Reception(rate_percent=95.0)}),
        {},
        "A sensor's samples came at 95.0 % of the rate set (limit 98.0 %). Check its sample rate",
    ),
    (
        walk(received={Site.LEFT_SHANK: Reception(rate_percent=50.1)}),
        {},
        "Every second sample of a sensor is missing: 50.1 % came (limit 90.0 %). Check its sample rate, move",
    ),
    (left(stance_percent=39.0), {}, "Stance takes 39.0 % of the stride (limit 40.0 %): the events may be wrong."),
    (left(stance_percent=86.0), {}, "Stance takes 86.0 % of the stride (limit 85.0 %): the events may be wrong."),
    (
        left(is_toe_off_biased=True),
        {},
        "A prosthetic foot rolls on, so toe-off is detected late. Stance is not compared or judged.",
    ),
    (left(length_m=1.4), {}, "Left and right stride length differ by 7.4 % (limit 5.0 %)."),
    (left(length_m=3.3), {}, "The walking speed found is 3.00 m/s (limit 2.50 m/s): the distance may be wrong."),
    (left(length_m=0.055), {}, "The walking speed found is 0.05 m/s (limit 0.10 m/s): the distance may be wrong."),
    (
        clocks(tie=ClockTie.UNKNOWN, residual_s=float("nan")),
        {},
        "Left and right sensors are not synchronised",
    ),
    (clocks(residual_s=0.010), {}, f"The clocks of both legs may be 10.0 ms apart (5.0 ms at most). {ONE}"),
    (clocks(lag_s=0.030), {}, f"The clocks of both legs may be 30.0 ms apart (5.0 ms at most). {ONE}"),
    (
        clocks(step_share_percent=57.0),
        {},
        "The left step takes 57.0 % of both (limit 55.0 %), though both feet stand equally",
    ),
    (
        clocks(step_share_percent=42.0),
        {},
        "The left step takes 42.0 % of both (limit 45.0 %), though both feet stand equally",
    ),
    (
        walk(drifting_percent={Site.LEFT_SHANK: 2.5}),
        {},
        "One sensor's clock runs 2.5 % faster or slower than the others'. Use",
    ),
]


@pytest.mark.parametrize(("recording", "knee", "expected"), CASES, ids=range(len(CASES)))
def test_a_reason_is_said_with_its_figures_and_their_unit(
    recording: RecordingAnalysis, knee: dict[str, Any], expected: str
) -> None:
    assert any(expected in one for one in said(recording, **knee)), said(recording, **knee)


def test_of_a_sound_walk_nothing_is_said() -> None:
    assert said(walk()) == set()


def test_what_a_device_stiffens_is_said_with_its_unit_too() -> None:
    assert said(left(knee_range_deg=4.0), stiff=(Side.LEFT,)) == said(left(knee_range_deg=4.0))


OF_HIPS = {
    *("hip_found", "hip_disagreement", "hip_centre", "hips_apart", "hip_heading", "hip_deep"),
    *("pelvis_tilt", "leg_clock"),
}


def test_every_gate_that_can_close_has_its_words_and_each_has_a_case() -> None:
    """Those of hips and pelvis are said in `tests/app/reports/test_pelvis_tables.py`."""
    closed = {
        reason.gate
        for recording, knee, _ in CASES
        for reason in reasons_of(verdicts_of(recording, calibrations(Joint.LEFT_KNEE, **knee), ()))
    }
    assert closed == set(WORDS) - OF_HIPS
    assert set(WITHOUT_FIGURES) <= set(WORDS)


def test_a_gate_without_a_figure_says_that_it_is_unknown() -> None:
    assert "is known to unknown only" not in gate_sentence(GateReason("axis", Verdict.WITHHELD, None, 9.0, "deg"))
    assert gate_words(GateReason("speed", Verdict.WITHHELD, None, 2.5, "m/s")).why.startswith(
        "The walking speed found is unknown"
    )


def test_each_verdict_has_its_word() -> None:
    assert {str(one): verdict_word(one) for one in Verdict} == {
        "read": "good",
        "care": "caution",
        "withheld": "withheld",
        "not_measured": "not measured",
    }

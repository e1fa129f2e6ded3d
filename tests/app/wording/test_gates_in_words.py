"""Tests that every reason for doubt is stated in words for a clinician.

Each has what was found, what was required and their unit.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from syrupy.assertion import SnapshotAssertion

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


KNEE: dict[str, dict[str, Any]] = {  # how the left knee of a sound walk is calibrated
    "clarity of the positions": {"sign_margin": 1.2},
    "no clarity is known": {"is_same_joint": False},
    "not two sides of one joint": {"is_same_joint": False, "sign_margin": 1.89, "disagreement": 0.26},
    "axis to be read with care": {"axis_sd_rad": np.deg2rad(7.0)},
    "axis not reported": {"axis_sd_rad": np.deg2rad(12.0)},
    "axis of unknown error": {"axis_sd_rad": None},
    "lag to be read with care": {"lag_sd_s": 0.004},
    "lag not reported": {"lag_sd_s": 0.02},
    "lag at the border": {"is_lag_at_border": True},
    "sign unclear": {"is_sign_certain": False, "clinical_sign_margin": 0.1},
    "sign unclear, by an unknown margin": {"is_sign_certain": False},
    "no standing reference": {"zero": ZeroKind.NONE},
}
WALKS: dict[str, RecordingAnalysis] = {
    "labels swapped": walk(doubted_sites=frozenset({Site.LEFT_SHANK, Site.LEFT_FOOT})),
    "halves of the walk apart": apart(12.0),
    "halves far apart": apart(55.0),
    "free motion and walk apart": apart(30.0, is_free_motion=True),
    "free motion and walk far apart": apart(40.0, is_free_motion=True),
    "knee hardly bent": left(knee_range_deg=4.0),
    "knee bent too far": left(knee_range_deg=91.0),
    "ankle hardly bent": left(ankle_range_deg=2.0),
    "knee overextended": left(knee_least_deg=-25.0),
    "ankle too high": left(ankle_least_deg=20.0),
    "strap moved in the walk": walk(slipped_from_s={Side.LEFT: 12.5}),
    "strap moved before it": walk(left=leg(Side.LEFT, 12, left_out=12), slipped_from_s={Side.LEFT: 0.0}),
    "five strides": walk(left=leg(Side.LEFT, 5)),
    "two strides": walk(left=leg(Side.LEFT, 2)),
    "range changed": left(knee_range_deg=60.0 + 5.0 * (GROWING > 0.5)),
    "stance changed": left(stance_percent=60.0 + 2.0 * (GROWING > 0.5)),
    "range drifted": left(knee_range_deg=60.0 + 6.0 * GROWING),
    "another stride time": left(time_s=1.1 * (1.0 + 0.1 * (GROWING > 0.5))),
    "every second stride": left(stance_percent=60.0 + np.tile([0.5, -0.5], 6) + 0.2 * GROWING),
    "gaps": walk(received={Site.LEFT_FOOT: with_gaps(2.0)}),
    "many gaps": walk(received={Site.LEFT_FOOT: with_gaps(6.0)}),
    "clipped": walk(received={Site.LEFT_FOOT: Reception(clipped_forces_s=np.array([12.0]))}),
    "rate too low": walk(received={Site.LEFT_SHANK: Reception(rate_percent=95.0)}),
    "half the rate": walk(received={Site.LEFT_SHANK: Reception(rate_percent=50.1)}),
    "short stance": left(stance_percent=39.0),
    "long stance": left(stance_percent=86.0),
    "prosthetic foot": left(is_toe_off_biased=True),
    "lengths differ": left(length_m=1.4),
    "too fast": left(length_m=3.3),
    "too slow": left(length_m=0.055),
    "clocks not tied": clocks(tie=ClockTie.UNKNOWN, residual_s=float("nan")),
    "clocks apart": clocks(residual_s=0.010),
    "one leg late": clocks(lag_s=0.030),
    "left step long": clocks(step_share_percent=57.0),
    "left step short": clocks(step_share_percent=42.0),
    "a clock drifts": walk(drifting_percent={Site.LEFT_SHANK: 2.5}),
}
CASES = {case: (walk(), knee) for case, knee in KNEE.items()} | {case: (one, {}) for case, one in WALKS.items()}


def test_a_reason_is_stated_with_its_figures_and_their_unit(snapshot: SnapshotAssertion) -> None:
    assert {case: sorted(stated(recording, **knee)) for case, (recording, knee) in CASES.items()} == snapshot


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
        for recording, knee in CASES.values()
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

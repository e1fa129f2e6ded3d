"""Tests that each gate closes beyond its limit and stays open at it. It hits what it may hit and nothing else.

Every limit is written out here, as TRUTH has it, never taken from the gates.
"""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from core.body import LEG_JOINTS, Joint, Side, Site
from core.calibration.same_joint import most_disagreement
from core.gait.clocks import ClockTie
from core.gait.strides import Reason
from core.results import Analysis, AxisHalves, Calibration, Method, RecordingAnalysis, ZeroKind
from core.session import RecordingKind
from core.timed.protocols import TimedProtocol
from core.verdicts.gates import judged, verdicts_of
from core.verdicts.model import GateReason, Verdict, Verdicts
from tests.core.timed.built_tests import built_test
from tests.core.verdicts.built_walk import SURE_CLOCKS, calibrations, leg, not_read, walk

KNEE, ANKLE = "left_knee", "left_ankle"
SHAPE_HEIGHT = ("shape", "height")
LEG = ("timing", "distance")


def gates_of(recording: RecordingAnalysis, reported: Any = None, stiff: tuple[Side, ...] = ()) -> Verdicts:
    return verdicts_of(recording, reported or calibrations(), stiff)


def left(**changes: Any) -> RecordingAnalysis:
    return walk(left=leg(Side.LEFT, **changes))


def hits(verdict: str, gate: str, of: str, *parts: str) -> dict[str, tuple[str, tuple[str, ...]]]:
    return {f"{of} {part}": (verdict, (gate,)) for part in parts}


def test_a_walk_of_which_all_is_sure_can_be_read_throughout() -> None:
    found = gates_of(walk())
    assert not_read(found) == {}
    assert set(found.joints) == set(LEG_JOINTS)
    assert set(found.legs) == set(Side)


JOINT_GATES = [
    ("pairing", {"sign_margin": 1.5}, {}),
    ("pairing", {"sign_margin": None}, {}),
    ("pairing", {"sign_margin": 1.49}, {"withheld": SHAPE_HEIGHT}),
    ("pairing", {"is_same_joint": False}, {"withheld": SHAPE_HEIGHT}),
    ("sign", {"is_sign_certain": False}, {"withheld": ("height", "sign")}),
    ("axis", {"axis_sd_rad": np.deg2rad(6.499)}, {}),
    ("axis", {"axis_sd_rad": np.deg2rad(6.6)}, {"care": SHAPE_HEIGHT}),
    ("axis", {"axis_sd_rad": np.deg2rad(8.999)}, {"care": SHAPE_HEIGHT}),
    ("axis", {"axis_sd_rad": np.deg2rad(9.1)}, {"withheld": SHAPE_HEIGHT}),
    ("axis", {"axis_sd_rad": None}, {"withheld": SHAPE_HEIGHT}),
    ("axis", {"axis_sd_rad": np.nan}, {"withheld": SHAPE_HEIGHT}),
    ("lag", {"lag_sd_s": 0.002}, {}),
    ("lag", {"lag_sd_s": 0.0021}, {"care": SHAPE_HEIGHT}),
    ("lag", {"lag_sd_s": 0.010}, {"care": SHAPE_HEIGHT}),
    ("lag", {"lag_sd_s": 0.0101}, {"withheld": SHAPE_HEIGHT}),
    ("lag", {"lag_sd_s": None}, {"withheld": SHAPE_HEIGHT}),
    ("lag", {"lag_sd_s": np.inf}, {"withheld": SHAPE_HEIGHT}),
    ("lag", {"is_lag_at_border": True}, {"withheld": SHAPE_HEIGHT}),
    ("lag", {"lag_sd_s": None, "is_clock_shared": True}, {}),
    ("zero", {"zero": ZeroKind.NONE}, {"withheld": ("height",)}),
    ("zero", {"zero": ZeroKind.GONIOMETER}, {}),
]


@pytest.mark.parametrize(("gate", "changes", "expected"), JOINT_GATES)
def test_what_a_calibration_states_hits_its_own_joint_alone(
    gate: str, changes: dict[str, Any], expected: dict[str, tuple[str, ...]]
) -> None:
    found = gates_of(walk(), calibrations(Joint.LEFT_KNEE, **changes))
    assert not_read(found) == {
        k: v for verdict, parts in expected.items() for k, v in hits(verdict, gate, KNEE, *parts).items()
    }


def test_a_reason_shows_what_was_found_and_what_would_have_passed() -> None:
    found = gates_of(walk(), calibrations(Joint.LEFT_KNEE, axis_sd_rad=np.deg2rad(7.0))).joint(Joint.LEFT_KNEE)
    (reason,) = found.shape.reasons
    assert (reason.limit, reason.unit) == (6.5, "deg")
    assert reason.value == pytest.approx(7.0)
    lag = gates_of(walk(), calibrations(Joint.LEFT_KNEE, lag_sd_s=0.02)).joint(Joint.LEFT_KNEE).shape.reasons
    assert lag == (GateReason("lag", Verdict.NOT_REPORTED, 20.0, 10.0, "ms"),)
    margin = {"is_sign_certain": False, "clinical_sign_margin": 0.1}
    (sign,) = gates_of(walk(), calibrations(Joint.LEFT_KNEE, **margin)).joint(Joint.LEFT_KNEE).sign.reasons
    assert (sign.value, sign.limit) == (0.1, 0.5)


@pytest.mark.parametrize(
    ("gate", "part", "changes"),
    [
        ("pairing", "shape", {"is_same_joint": False, "sign_margin": 3.0}),
        ("sign", "sign", {"is_sign_certain": False, "clinical_sign_margin": 0.99}),
        ("lag", "shape", {"is_lag_at_border": True, "lag_sd_s": 0.001}),
    ],
)
def test_a_figure_that_would_have_passed_is_not_given_as_the_reason(
    gate: str, part: str, changes: dict[str, Any]
) -> None:
    """As of a stiff knee, whose few degrees report no sign however clearly they lean one way."""
    found = gates_of(walk(), calibrations(Joint.LEFT_KNEE, **changes)).joint(Joint.LEFT_KNEE)
    (reason,) = getattr(found, part).reasons
    assert (reason.gate, reason.verdict, reason.value) == (gate, Verdict.NOT_REPORTED, None)


@pytest.mark.parametrize(
    ("gate", "changes", "figures"),
    [
        ("pairing", {"sign_margin": 1.2, "disagreement": 0.5}, (1.2, 1.5)),
        ("disagreement", {"sign_margin": 1.89, "disagreement": 0.26}, (0.26, 0.2)),
        ("disagreement", {"sign_margin": 5.0, "disagreement": 0.4}, (0.4, 0.33)),
        ("lag", {"sign_margin": 5.0, "disagreement": 0.1, "is_lag_at_border": True}, (None, 10.0)),
        ("pairing", {"sign_margin": 5.0, "disagreement": None}, (None, 1.5)),  # of an analysis that kept no figure
    ],
)
def test_sensors_that_are_not_of_one_joint_are_refused_by_the_gate_that_decided_it(
    gate: str, changes: dict[str, Any], figures: tuple[float | None, float]
) -> None:
    found = gates_of(walk(), calibrations(Joint.LEFT_KNEE, is_same_joint=False, **changes)).joint(Joint.LEFT_KNEE)
    (reason,) = found.shape.reasons
    assert (reason.gate, reason.verdict, reason.value, reason.limit) == (gate, Verdict.NOT_REPORTED, *figures)


@pytest.mark.parametrize(("margin", "disagreement"), [(1.6, 0.19), (3.2, 0.32), (9.0, 0.6)])
def test_sensors_that_agree_well_enough_for_their_margin_may_be_of_one_joint(
    margin: float, disagreement: float
) -> None:
    most = most_disagreement(margin)
    assert most is None or disagreement <= most


@pytest.mark.parametrize(
    ("is_free_motion", "apart_deg", "verdict"),
    [
        *((False, 9.99, None), (False, 10.1, "care"), (False, 24.9, "care"), (False, 25.1, "withheld")),
        *((True, 23.9, None), (True, 24.1, "care"), (True, 32.9, "care"), (True, 33.1, "withheld")),
    ],
)
def test_axes_that_come_out_apart_in_two_parts_hit_their_own_joint_alone(
    is_free_motion: bool, apart_deg: float, verdict: str | None
) -> None:
    halves = {Joint.LEFT_ANKLE: AxisHalves(np.deg2rad(apart_deg), 0.01, is_free_motion, {})}
    gate = "axis_motions" if is_free_motion else "axis_halves"
    closed = hits(verdict, gate, ANKLE, *SHAPE_HEIGHT) if verdict else {}
    assert not_read(gates_of(walk(axis_halves=halves))) == closed
    assert not_read(gates_of(walk(axis_halves=halves, timed=built_test(TimedProtocol.TWO_MINUTES)))) == closed


def test_a_foot_sensor_that_may_be_on_another_foot_puts_its_legs_strides_in_doubt() -> None:
    found = gates_of(walk(), calibrations(Joint.LEFT_ANKLE, sign_margin=1.1))
    assert not_read(found) == {
        **hits("withheld", "pairing", ANKLE, *SHAPE_HEIGHT),
        **hits("care", "pairing", "left", *LEG),
    }


@pytest.mark.parametrize(
    ("changes", "joint", "verdict"),
    [
        ({"knee_range_deg": 5.01}, KNEE, ""),
        ({"knee_range_deg": 4.9}, KNEE, "withheld"),
        ({"knee_range_deg": 89.9}, KNEE, ""),
        ({"knee_range_deg": 90.1}, KNEE, "withheld"),
        ({"ankle_range_deg": 3.01}, ANKLE, ""),
        ({"ankle_range_deg": 2.9}, ANKLE, "withheld"),
        ({"ankle_range_deg": 59.9, "ankle_least_deg": -30.0}, ANKLE, ""),
        ({"ankle_range_deg": 60.1, "ankle_least_deg": -30.0}, ANKLE, "withheld"),
    ],
)
def test_a_range_that_no_walking_joint_has(changes: dict[str, float], joint: str, verdict: str) -> None:
    expected = hits(verdict, "plausible", joint, *SHAPE_HEIGHT) if verdict else {}
    assert not_read(gates_of(left(**changes))) == expected


def test_a_joint_that_a_device_stiffens_may_hardly_bend_and_never_bend_too_far() -> None:
    stiff = not_read(gates_of(left(knee_range_deg=4.0), stiff=(Side.LEFT,)))
    assert stiff == hits("care", "plausible", KNEE, *SHAPE_HEIGHT)
    other = not_read(gates_of(left(knee_range_deg=4.0), stiff=(Side.RIGHT,)))
    assert other == hits("withheld", "plausible", KNEE, *SHAPE_HEIGHT)
    far = not_read(gates_of(left(knee_range_deg=91.0), stiff=(Side.LEFT,)))
    assert far == hits("withheld", "plausible", KNEE, *SHAPE_HEIGHT)


@pytest.mark.parametrize(
    ("changes", "joint", "is_closed"),
    [
        ({"knee_least_deg": -19.9}, KNEE, False),
        ({"knee_least_deg": -20.1}, KNEE, True),
        ({"knee_least_deg": 60.0}, KNEE, False),
        ({"ankle_least_deg": -44.9}, ANKLE, False),
        ({"ankle_least_deg": -45.1}, ANKLE, True),
        ({"ankle_least_deg": 14.9}, ANKLE, False),  # up to 39.9
        ({"ankle_least_deg": 15.1}, ANKLE, True),
    ],
)
def test_a_height_that_no_walking_joint_has_leaves_its_shape(
    changes: dict[str, float], joint: str, is_closed: bool
) -> None:
    expected = hits("withheld", "plausible_height", joint, "height") if is_closed else {}
    assert not_read(gates_of(left(**changes))) == expected


@pytest.mark.parametrize(
    ("used", "verdict"), [(10, ""), (9, "care"), (3, "care"), (2, "withheld"), (1, "withheld"), (0, "withheld")]
)
def test_few_strides_are_read_with_care_and_fewer_not_reported(used: int, verdict: str) -> None:
    found = not_read(gates_of(left(left_out=12 - used)))
    expected = {}
    if verdict:
        expected = {
            **hits(verdict, "strides", KNEE, *SHAPE_HEIGHT),
            **hits(verdict, "strides", ANKLE, *SHAPE_HEIGHT),
            **hits(verdict, "strides", "left", *LEG),
        }
    assert found == expected


def test_strides_with_gaps_in_the_angle_count_for_the_leg_and_not_for_the_joint() -> None:
    gait = leg(Side.LEFT)
    cycles = {joint: curves.copy() for joint, curves in gait.cycles.items()}
    cycles[Joint.LEFT_KNEE][2:] = np.nan
    found = not_read(gates_of(walk(left=replace(gait, cycles=cycles))))
    assert found == hits("withheld", "strides", KNEE, *SHAPE_HEIGHT)


def halves(first: float, second: float) -> Any:
    return np.repeat([first, second], 6)


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"knee_range_deg": halves(60.0, 61.9)}, {}),
        ({"knee_range_deg": halves(60.0, 62.1)}, hits("care", "halves", KNEE, *SHAPE_HEIGHT)),
        ({"stance_percent": halves(60.0, 61.4)}, {}),
        ({"stance_percent": halves(60.0, 58.4)}, hits("care", "halves", "left", "timing")),
        ({"time_s": halves(1.1, 1.14)}, {}),
        # only the stride time, whose halves say how far the walk changed its pace
        ({"time_s": halves(1.1, 1.16)}, hits("care", "halves_time", "left", "timing")),
    ],
)
def test_halves_of_a_walk_that_differ_are_read_with_care(changes: dict[str, Any], expected: dict[str, Any]) -> None:
    length = {"length_m": 1.3}
    assert not_read(gates_of(left(**length, **changes))) == expected


def test_the_halves_of_five_strides_say_nothing() -> None:
    gait = leg(Side.LEFT, 5, knee_range_deg=np.array([50.0, 50.0, 60.0, 60.0, 60.0]))
    assert not_read(gates_of(walk(left=gait)))[f"{KNEE} shape"] == ("care", ("strides",))


def thirds(last: float) -> Any:
    """Strides whose halves differ by less than 2 where the thirds differ by `last`."""
    return 60.0 + np.concatenate([np.zeros(4), np.full(4, 0.5 * last), np.full(4, last)])


def test_a_range_that_drifts_is_read_with_care() -> None:
    assert not_read(gates_of(left(knee_range_deg=thirds(2.6)))) == {}
    found = gates_of(left(knee_range_deg=thirds(3.1)))
    assert {reason.gate for reason in found.joint(Joint.LEFT_KNEE).shape.reasons} >= {"drift"}
    assert found.joint(Joint.LEFT_KNEE).shape.verdict is Verdict.CARE


def test_a_height_that_drifts_leaves_the_shape() -> None:
    assert not_read(gates_of(left(knee_least_deg=thirds(2.9) - 60.0))) == {}
    drifted = not_read(gates_of(left(knee_least_deg=thirds(3.1) - 60.0)))
    assert drifted == hits("care", "drift", KNEE, "height")


def odd_even(apart: float, spread: float) -> Any:
    """Twelve values, every second `apart` higher, each six with a standard deviation of `spread`."""
    six = np.array([-1.0, 1.0, -1.0, 1.0, -1.0, 1.0]) * spread * np.sqrt(5 / 6)
    values = np.empty(12)
    values[::2], values[1::2] = six, six + apart
    return values


def test_every_second_stride_unlike_the_others_is_read_with_care() -> None:
    """Both sixes have an SD of 1: their means differ by the square root of 2/6, 0.577, by chance."""
    assert not_read(gates_of(left(knee_range_deg=60.0 + odd_even(1.72, 1.0)))) == {}
    found = not_read(gates_of(left(knee_range_deg=60.0 + odd_even(1.75, 1.0))))
    assert found == hits("care", "odd_even", KNEE, *SHAPE_HEIGHT)
    timing = not_read(gates_of(left(stance_percent=60.0 + odd_even(1.75, 1.0))))
    assert timing == hits("care", "odd_even", "left", "timing")


def with_slip(recording: RecordingAnalysis, from_s: float, *, leaves: int) -> RecordingAnalysis:
    gait = recording.gait[Side.LEFT]
    n = len(gait.strides)
    strides = replace(gait.strides, reason=(Reason.USED,) * leaves + (Reason.SLIPPED,) * (n - leaves))
    legs = {**recording.gait, Side.LEFT: replace(gait, strides=strides)}
    return replace(recording, gait=legs, slipped_from_s={Side.LEFT: from_s})


def test_a_strap_that_slips_costs_what_comes_after_it() -> None:
    found = gates_of(with_slip(walk(left=leg(Side.LEFT, 14)), 21.0, leaves=10))
    expected = {
        **hits("care", "strap", KNEE, *SHAPE_HEIGHT),
        **hits("care", "strap", ANKLE, *SHAPE_HEIGHT),
        **hits("care", "strap", "left", *LEG),
    }
    assert not_read(found) == expected
    (reason,) = found.leg(Side.LEFT).timing.reasons
    assert (reason.value, reason.unit) == (21.0, "s")
    none = gates_of(with_slip(walk(), -np.inf, leaves=0))
    assert {verdict for verdict, _ in not_read(none).values()} == {"withheld"}
    assert none.leg(Side.RIGHT).timing.verdict is Verdict.READ
    assert GateReason("strap", Verdict.NOT_REPORTED) in none.joint(Joint.LEFT_KNEE).shape.reasons


@pytest.mark.parametrize(("percent", "is_closed"), [(40.1, False), (39.9, True), (84.9, False), (85.1, True)])
def test_a_stance_that_no_walk_has_puts_the_events_in_doubt(percent: float, is_closed: bool) -> None:
    found = not_read(gates_of(left(stance_percent=percent)))
    assert found == (hits("withheld", "events", "left", *LEG) if is_closed else {})


def test_feet_that_did_not_go_equally_far_are_read_with_care() -> None:
    assert not_read(gates_of(left(length_m=1.3 * 1.05))) == {}  # 4.9 % of their mean
    found = not_read(gates_of(left(length_m=1.3 * 1.052)))
    assert found == {**hits("care", "distance", "left", "distance"), **hits("care", "distance", "right", "distance")}


@pytest.mark.parametrize(("speed_m_s", "is_closed"), [(0.101, False), (0.099, True), (2.499, False), (2.501, True)])
def test_a_speed_that_no_walk_has_withholds_the_distances(speed_m_s: float, is_closed: bool) -> None:
    feet = {str(side): leg(side, length_m=1.1 * speed_m_s) for side in Side}
    expected = {k: v for side in Side for k, v in hits("withheld", "speed", side, "distance").items()}
    assert not_read(gates_of(walk(**feet))) == (expected if is_closed else {})


def test_a_shank_alone_measures_no_distance_and_that_is_no_doubt() -> None:
    found = gates_of(left(length_m=np.nan))
    assert not_read(found) == {"left distance": ("not_measured", ())}


def test_a_toe_off_that_is_always_late_is_read_with_care() -> None:
    found = not_read(gates_of(left(is_toe_off_biased=True)))
    assert found == hits("care", "toe_off", "left", "timing")


UNKNOWN = {"tie": ClockTie.UNKNOWN, "residual_s": np.nan}


@pytest.mark.parametrize(
    ("changes", "verdict", "gate", "value", "limit"),
    [
        ({"residual_s": 0.005}, "read", "", None, None),
        ({"residual_s": 0.0051}, "care", "clocks", 5.1, 5.0),
        ({"residual_s": 0.020}, "care", "clocks", 20.0, 5.0),
        ({"residual_s": 0.0201}, "withheld", "clocks", 20.1, 20.0),
        (UNKNOWN, "withheld", "clocks", None, 20.0),
        ({"lag_s": 0.0049}, "read", "", None, None),
        ({"lag_s": 0.005}, "withheld", "clocks", 5.0, 5.0),
        ({"step_share_percent": 55.0}, "read", "", None, None),
        ({"step_share_percent": 55.1}, "withheld", "step_share", 55.1, 55.0),
        ({"step_share_percent": 44.9}, "withheld", "step_share", 44.9, 45.0),
        ({"step_share_percent": 60.0, "stance_difference_percent": 3.0}, "read", "", None, None),
        ({"step_share_percent": 60.0, "stance_difference_percent": -2.9}, "withheld", "step_share", 60.0, 55.0),
    ],
)
def test_what_compares_both_legs_needs_one_clock(
    changes: dict[str, Any], verdict: str, gate: str, value: float | None, limit: float | None
) -> None:
    found = gates_of(walk(clocks=replace(SURE_CLOCKS, **changes)))
    assert not_read(found) == ({} if verdict == "read" else {"between": (verdict, (gate,))})
    if gate:
        (reason,) = found.between.reasons
        assert reason.value == (None if value is None else pytest.approx(value))
        assert reason.limit == pytest.approx(limit)


def test_one_leg_alone_compares_with_nothing() -> None:
    both = walk()
    alone = gates_of(replace(both, gait={Side.LEFT: both.gait[Side.LEFT]}))
    assert alone.between.verdict is gates_of(replace(both, clocks=None)).between.verdict is Verdict.NOT_MEASURED
    assert set(alone.legs) == {Side.LEFT}


def test_a_free_motion_has_joints_and_no_legs() -> None:
    found = gates_of(walk(kind=RecordingKind.FREE_MOTION), calibrations(Joint.LEFT_KNEE, zero=ZeroKind.NONE))
    assert not_read(found) == {
        **hits("withheld", "zero", KNEE, "height"),
        "between": ("not_measured", ()),
    }
    assert found.legs == {}


def test_several_gates_are_all_reported_the_gravest_first() -> None:
    reported = calibrations(Joint.LEFT_KNEE, axis_sd_rad=np.deg2rad(7.0), sign_margin=1.0)
    found = gates_of(left(left_out=3), reported).joint(Joint.LEFT_KNEE).shape
    assert [(reason.gate, str(reason.verdict)) for reason in found.reasons] == [
        ("pairing", "withheld"),
        ("axis", "care"),
        ("strides", "care"),
    ]


def test_an_analysis_is_judged_with_what_each_recording_was_measured_with() -> None:
    span = Calibration(("walk 1",), calibrations(Joint.LEFT_KNEE, zero=ZeroKind.NONE))
    other = Calibration(("walk 2",), calibrations())
    two = replace(walk(), name="walk 2")
    found = judged(Analysis(Method.ROBUST, True, (span, other), (left(knee_range_deg=4.0), two)))
    first, second = (recording.verdicts for recording in found.recordings)
    assert not_read(second) == {}
    assert not_read(first)[f"{KNEE} shape"] == ("withheld", ("plausible",))
    assert "zero" in not_read(first)[f"{KNEE} height"][1]


def test_a_clock_that_runs_away_withholds_its_joints_and_what_compares_the_legs() -> None:
    found = gates_of(replace(walk(), drifting_percent={Site.LEFT_SHANK: 2.0}))
    gate = ("clock_drift",)
    both = {f"left_{kind} {part}": ("withheld", gate) for kind in ("knee", "ankle") for part in ("shape", "height")}
    assert not_read(found) == {**both, "between": ("withheld", gate)}
    of_foot = not_read(gates_of(replace(walk(), drifting_percent={Site.RIGHT_FOOT: -2.0})))
    assert of_foot["right timing"] == ("care", gate)
    assert not any(name.startswith(("left", "right_knee")) for name in of_foot)

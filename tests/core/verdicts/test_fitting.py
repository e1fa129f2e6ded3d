"""Each measure for fitting rests on the right verdict and is reported in the one table."""

import pytest

from core.body import LEG_JOINTS, Joint, Side
from core.parameters import ParameterFile, columns_of
from core.verdicts.fitting import BY_COLUMN, MEASURES
from core.verdicts.model import READ, Assessment, JointVerdicts, LegVerdicts, Verdict, Verdicts
from core.verdicts.quantities import FITTING, assessment_of
from core.verdicts.sigmas import KINDS, ComparisonKind, sigma_of

BAD = Assessment(Verdict.NOT_REPORTED)
INSTANTS = ("initial_contact", "mid_stance", "toe_off")
# what each measure needs, written out
LEANING = {f"{segment}_at_{instant}_deg" for segment in ("shank", "thigh") for instant in INSTANTS}
TURNING = {f"shank_{name}_deg" for name in ("heel_rocker", "over_flat_foot", "forefoot_rocker")}
FOOT = {"foot_pitch_at_contact_deg", "foot_heel_rise_deg"}
SET = {"shank_to_foot_in_swing_deg"}  # of shank and foot alike
KNEE_SIGNED = {"knee_terminal_extension_deg", "knee_extended_before_contact_percent"}


def verdicts(
    joint: Joint | None = None, part: str = "", timing: Assessment = READ, distance: Assessment = READ
) -> Verdicts:
    """All of the left leg can be read but what is named."""
    found = {
        one: JointVerdicts(
            **{name: BAD if (one, name) == (joint, part) else READ for name in ("shape", "height", "sign")}
        )
        for one in LEG_JOINTS
    }
    return Verdicts(found, {Side.LEFT: LegVerdicts(timing, distance), Side.RIGHT: LegVerdicts(READ, READ)}, READ)


@pytest.mark.parametrize(
    ("found", "expected"),
    [
        (verdicts(), set()),
        (verdicts(Joint.LEFT_KNEE, "height"), {*LEANING, *SET, "knee_terminal_extension_deg"}),
        (verdicts(Joint.LEFT_KNEE, "shape"), {*TURNING, "knee_extended_before_contact_percent"}),
        (verdicts(Joint.LEFT_KNEE, "sign"), {*LEANING, *TURNING, *SET, *KNEE_SIGNED}),
        (verdicts(Joint.LEFT_ANKLE, "shape"), set()),
        (verdicts(Joint.RIGHT_KNEE, "sign"), set()),
        (verdicts(timing=BAD), {*LEANING, *TURNING, *SET, "foot_flat_percent"}),
        (verdicts(distance=BAD), {*FOOT, *SET}),
    ],
)
def test_a_measure_is_not_reported_where_what_it_rests_on_is(found: Verdicts, expected: set[str]) -> None:
    assert {name for name in FITTING if not assessment_of(found, Side.LEFT, name).is_reported} == expected


def test_every_measure_is_defined_once_and_states_what_it_cannot() -> None:
    assert {*LEANING, *TURNING, *FOOT, *SET, *KNEE_SIGNED, "foot_flat_percent"} == set(FITTING)
    assert set(FITTING) <= set(BY_COLUMN) <= {*FITTING, *columns_of(ParameterFile.STRIDES, ParameterFile.PEAKS)}
    assert len(BY_COLUMN) == len(MEASURES)
    assert all(measure.definition and measure.cannot_say and measure.source for measure in MEASURES)
    assert not set(FITTING) & set(
        columns_of(ParameterFile.STRIDES, ParameterFile.PEAKS)
    )  # the older tables keep their rows
    assert not any("step_length" in column for column in BY_COLUMN)  # the feet's distance is unknown


def test_every_measure_of_fitting_is_judged_and_those_of_segments_keep_their_dagger() -> None:
    """Feet were measured on people who came twice; of thigh and shank the knee's error is taken.

    How a foot is set is judged with the sensors left on alone.
    """
    assert set(FITTING) <= set(KINDS)
    (set_angle,) = SET
    assert {kind for kind in ComparisonKind if sigma_of(set_angle, kind) is not None} == {
        ComparisonKind.ATTACHED,
        ComparisonKind.HALVES,
    }
    for name in (one for one in FITTING if one not in SET):
        for kind in ComparisonKind:
            sigma = sigma_of(name, kind)
            assert sigma is not None, (name, kind)
            is_own = name.startswith("foot") or name == "knee_terminal_extension_deg"
            assert sigma.is_verified is (is_own or kind is ComparisonKind.HALVES), (name, kind)

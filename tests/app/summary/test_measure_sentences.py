"""Changes and null results as sentences: a verb for each measure, values with units, nothing that is lost."""

import pytest

from app.summary.measure_sentences import (
    Reported,
    change_sentence,
    legs_sentence,
    similar_sentence,
    who_in_sentence,
)
from app.wording.measures import NAMES, WITH_UNIT, name_in_sentence, name_with_unit
from core.body import Side
from core.parameters import COMPARED
from core.verdicts.measurement_error import Difference, Judgement


def changed(column: str, difference: float, now: float, before: float) -> str:
    who = who_in_sentence(column, Side.LEFT)
    stated = change_sentence(column, who, difference, Reported("with B", now), Reported("with A", before))
    return stated.replace("\N{NO-BREAK SPACE}", " ")


def test_a_joint_does_what_its_measure_is_of() -> None:
    more = "Left knee flexes 54.0° from stance to swing with B, 5.0° more than with A (49.0°)."
    assert changed("knee_stance_to_swing_deg", 5.0, 54.0, 49.0) == more
    less = "Left ankle plantarflexes 12.0° at push-off with B, 3.0° less than with A (15.0°)."
    assert changed("ankle_push_off_deg", -3.0, 12.0, 15.0) == less
    speed = "Walking speed is 1.20 m/s with B, 0.10 m/s more than with A (1.10 m/s)."
    assert changed("speed_m_s", 0.1, 1.2, 1.1) == speed


def test_a_share_of_the_gait_cycle_is_named_so_that_it_is_no_relative_change() -> None:
    assert "2.0 % of the gait cycle more than with A (59.0 %)" in changed("stance_percent", 2.0, 61.0, 59.0)


@pytest.mark.parametrize("column", COMPARED)
def test_every_compared_measure_has_a_whole_sentence_with_all_its_values(column: str) -> None:
    stated = changed(column, -4.0, 50.0, 54.0)
    assert stated[0].isupper()
    assert stated.endswith(").")
    assert all(number in stated for number in ("50", "4", "54"))
    assert "{" not in stated


def test_a_difference_is_subtracted_before_it_is_rounded_and_no_value_contradicts_it() -> None:
    assert changed("speed_m_s", 0.388, 1.184, 0.796).endswith("1.18 m/s with B, 0.39 m/s more than with A.")
    assert changed("speed_m_s", -0.388, 0.796, 1.184).endswith("0.80 m/s with B, 0.39 m/s less than with A.")
    assert "1.19 m/s with B, 0.39 m/s more than with A (0.80 m/s)" in changed("speed_m_s", 0.39, 1.19, 0.80)


def test_a_null_result_has_both_values() -> None:
    now, before = Reported("with B", 61.0), Reported("with A", 60.0)
    similar = similar_sentence("knee_range_deg", "Prosthetic side", 1.0, now, before)
    assert similar == "Prosthetic side: knee range of motion is similar with A and with B, 60.0° and 61.0°."


def test_the_legs_are_reported_with_a_verb_too() -> None:
    found = Difference(-5.0, 2.0, Judgement.EXCEEDS_ERROR)
    stated = legs_sentence("ankle_rocker_deg", found, ("left", "right"), (10.0, 15.0))
    assert stated == "The left ankle dorsiflexes 5.0° less in stance than the right: 10.0° against 15.0°."


def test_a_measure_has_one_name_in_a_table_and_within_a_sentence() -> None:
    for column, name in NAMES.items():
        assert name_in_sentence(column).casefold() == name.casefold()
        assert name_with_unit(column).startswith(name)
        assert name_with_unit(column).count("%") <= 1
    assert set(WITH_UNIT) <= set(NAMES)

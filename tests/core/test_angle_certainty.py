"""Two standard deviations of an angle hold nine samples of ten, whatever tissue does and whatever is declared."""

from dataclasses import replace

import pytest

from core.body import LEG_SITES, Side
from devices.simulation.walker import Standing, Walk, WalkerSettings
from tests.benchmarks.certainty import (
    OF_LEVEL,
    OF_SIDE,
    SETTINGS,
    TISSUES,
    WORN,
    Coverage,
    Wearer,
    coverages,
    fitted_wearers,
)

LEFT = tuple(site for site in LEG_SITES if site.side is Side.LEFT)  # nothing is worn on the other leg
WALK = WalkerSettings(recordings=(Standing(), Walk(strides=6)), sites=LEFT)


def covered(settings: WalkerSettings, tissue: str, worn: Wearer, seeds: range) -> dict[str, list[Coverage]]:
    kind, turn_rad = TISSUES[tissue]
    found: dict[str, list[Coverage]] = {}
    for seed in seeds:
        of_seed = replace(settings, seed=seed, tissue=kind, tissue_turn_rad=turn_rad)
        for name, coverage in coverages(of_seed, worn):
            found.setdefault(name, []).append(coverage)
    return found


def assert_held(found: dict[str, list[Coverage]], share: float = 0.9) -> None:
    for name, many in found.items():
        held = sum(one.inside for one in many) / sum(one.samples for one in many)
        assert held >= share, f"{name}: {100 * held:.0f} %"


def test_an_ankle_under_tissue_that_turns_in_step_is_as_sure_as_it_states() -> None:
    """No rate shows such a turn, and the spread that claimed to see that there is none held 0.78."""
    found = covered(WALK, "soft, turning", WORN["person"], range(1))
    assert_held({name: many for name, many in found.items() if name.startswith("ankle")})


def test_a_declared_ankle_without_tissue_is_surer_than_a_person_s() -> None:
    kinds = [covered(WALK, "rigid", WORN[worn], range(1))["ankle, walking"] for worn in ("person", "with play")]
    person, prosthesis = (sum(one.sd for one in many) / len(many) for many in kinds)
    assert prosthesis < 0.1 * person
    assert_held({"ankle with play": kinds[1]})


def share_of(found: dict[str, list[Coverage]], name: str) -> float:
    return sum(one.inside for one in found[name]) / sum(one.samples for one in found[name])


def test_the_ankle_that_a_partial_foot_leaves_is_as_sure_as_a_person_s_once_that_is_stated() -> None:
    """Of the side alone it was taken for the prosthesis's, and 2 sd held two thirds of its samples."""
    wearers = fitted_wearers()["partial foot"]
    held = {
        declared: share_of(covered(WALK, "soft, turning", wearer, range(1)), "ankle, walking")
        for declared, wearer in wearers.items()
    }
    assert held[OF_SIDE] < 0.7
    assert held[OF_LEVEL] >= 0.9


@pytest.mark.parametrize("worn", ["transtibial, sach", "transtibial, energy_storing"])
def test_the_knee_above_a_transtibial_prosthesis_is_a_person_s_and_its_foot_no_hinge(worn: str) -> None:
    wearers = fitted_wearers()[worn]
    found = covered(WALK, "soft, turning", wearers[OF_LEVEL], range(1))
    assert set(found) == {"knee, walking", "hinge, ankle, walking"}
    assert_held(found)
    (rigid,) = found["hinge, ankle, walking"]
    (hinge,) = covered(WALK, "soft, turning", wearers[OF_SIDE], range(1))["hinge, ankle, walking"]
    assert rigid.sd > 2.0 * hinge.sd, "a foot that does not bend proves no hinge"


@pytest.mark.endurance
@pytest.mark.parametrize("worn", WORN)
@pytest.mark.parametrize("tissue", TISSUES)
def test_two_standard_deviations_hold_nine_samples_of_ten(tissue: str, worn: str) -> None:
    """Of many sessions, as the benchmark has them; here two, which scatter."""
    if worn == "with play" and tissue != "rigid":
        pytest.skip("an ankle with play has no tissue")
    assert_held(covered(SETTINGS["free motion, walk"], tissue, WORN[worn], range(50, 52)), share=0.85)

"""Tests that names show where a sensor was worn, and show nothing where they do not state it."""

import pytest

from core.body import Site
from devices.files.site_names import site_of_name, without_site

T, S, F = Site.LEFT_THIGH, Site.LEFT_SHANK, Site.LEFT_FOOT


@pytest.mark.parametrize(
    ("name", "site"),
    [
        ("Left Thigh", T),
        ("left_thigh", T),
        ("femur_l_imu", T),
        ("LeftUpperLeg", T),
        ("Oberschenkel links", T),
        ("Left Lower Leg", S),
        ("tibia_l", S),
        ("walk 2 left shank", S),
        ("calcn_l", F),
        ("L_Foot", F),
        ("RightFoot", Site.RIGHT_FOOT),
        ("right-shank", Site.RIGHT_SHANK),
        ("pelvis_imu", Site.PELVIS),
        ("Pelvis", Site.PELVIS),
        ("Becken", Site.PELVIS),
        ("pelvis and left foot", None),
        ("Lumbar", None),
        ("left hip", None),
        ("", None),
        ("Left", None),
        ("thigh", None),
        ("MT_012005D6_009-001_00B421E6", None),
        ("left hand", None),
        ("left foot and right foot", None),
        ("left thigh shank", None),
        ("Right Ankle", None),  # some wear it above the joint, some below
        ("left forearm near the thigh", None),
    ],
)
def test_a_name_states_one_site_or_none(name: str, site: Site | None) -> None:
    assert site_of_name(name) is site


@pytest.mark.parametrize(
    ("name", "common"),
    [
        ("walk_1_left_thigh", "walk_1"),
        ("walk_1_RightLowerLeg", "walk_1"),
        ("MT_012005D6_009-001_00B421E6", "MT_012005D6_009_001"),
        ("left_thigh", ""),
        ("trial_left_thigh_00B421E6", "trial"),
        ("trial_20260301", "trial"),
        ("left_turn", "left_turn"),  # states no site, so nothing of it is one
    ],
)
def test_what_the_sensors_of_a_trial_have_in_common(name: str, common: str) -> None:
    assert without_site(name) == common

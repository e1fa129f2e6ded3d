"""Silent sensors: reported after two seconds, with what they cost, and once more when they are back."""

from app.wizard.losses import NOTHING, Losses
from core.body import LEG_JOINTS, LEG_SITES, Joint, Site

ALL = list(LEG_JOINTS)


def test_a_short_silence_is_nobodys_business() -> None:
    losses = Losses()
    assert losses.update({Site.RIGHT_FOOT: 1.9}, 10.0) == ()
    assert losses.message(True, ALL, 10.0) == NOTHING


def test_a_silent_sensor_is_news_once() -> None:
    losses = Losses()
    assert losses.update({Site.RIGHT_FOOT: 2.1}, 10.0) == (Site.RIGHT_FOOT,)
    assert losses.update({Site.RIGHT_FOOT: 3.1}, 11.0) == ()
    assert losses.message(True, ALL, 11.0) == (
        "R foot: no signal for 3 s.",
        "Recording continues. Missing until the signal is back: right ankle, right gait phases.",
    )


def test_between_walks_it_states_what_to_do() -> None:
    losses = Losses()
    losses.update({Site.LEFT_SHANK: 4.2}, 10.0)
    assert losses.message(False, ALL, 10.0) == (
        "L shank: no signal for 4 s.",
        "Switch the sensor off and on, or continue without these angles: left knee, left ankle.",
    )


def test_its_return_is_reported_with_how_long_it_was() -> None:
    losses = Losses()
    losses.update({Site.RIGHT_FOOT: 3.1}, 10.0)
    losses.update({Site.RIGHT_FOOT: 0.02}, 10.1)
    assert losses.message(True, ALL, 11.0) == (
        "R foot: signal back after 3.1 s.",
        "Strides in between are excluded.",
    )
    assert losses.message(True, ALL, 20.0) == NOTHING


def test_a_sensor_worn_no_more_is_forgotten() -> None:
    losses = Losses()
    losses.update({Site.RIGHT_FOOT: 3.1}, 10.0)
    losses.update({}, 10.1)
    assert losses.message(True, ALL, 10.1) == NOTHING


def test_two_are_reported_together() -> None:
    losses = Losses()
    losses.update({Site.RIGHT_FOOT: 3.1, Site.LEFT_FOOT: 5.0, Site.LEFT_SHANK: 0.0}, 10.0)
    assert losses.message(True, [], 10.0) == (
        "L foot, R foot: no signal for 5 s.",
        "Recording continues. Missing until the signal is back: left gait phases, right gait phases.",
    )
    assert losses.message(False, [], 10.0)[1] == "Switch the sensors off and on, or continue without them."


def test_where_none_is_received_the_receiver_is_reported_of_and_their_return_is_reported_together() -> None:
    losses = Losses()
    losses.update(dict.fromkeys(LEG_SITES, 3.0), 10.0)
    then = "Check that the receiver is plugged in and near the patient, and that the sensors are switched on."
    assert losses.message(False, ALL, 10.0) == ("No signal from any sensor for 3 s.", then)
    assert losses.message(True, ALL, 10.0)[1] == f"Recording continues. {then}"
    losses.update({**dict.fromkeys(LEG_SITES, 0.02), Site.LEFT_FOOT: 3.5}, 10.5)
    losses.update(dict.fromkeys(LEG_SITES, 0.02), 11.0)
    assert losses.message(True, ALL, 11.0)[0] == "All sensors: signal back after 3.5 s."
    losses.update({**dict.fromkeys(LEG_SITES, 0.02), Site.LEFT_FOOT: 2.1}, 20.0)
    losses.update(dict.fromkeys(LEG_SITES, 0.02), 20.5)
    assert losses.message(True, ALL, 20.5)[0] == "L foot: signal back after 2.1 s."


HIPS = [Joint.LEFT_HIP, Joint.RIGHT_HIP]


def test_a_silent_pelvis_costs_the_hips_and_states_that_the_rest_goes_on() -> None:
    losses = Losses()
    assert losses.update({Site.PELVIS: 3.1, Site.LEFT_FOOT: 0.0}, 10.0) == (Site.PELVIS,)
    assert losses.message(True, [*ALL, *HIPS], 11.0) == (
        "Pelvis: no signal for 3 s.",
        "Recording continues, including knees and ankles. Hip angles are missing until the signal is back.",
    )
    assert (
        losses.message(False, [*ALL, *HIPS], 11.0)[1]
        == "Switch the pelvis sensor off and on, or continue without hip angles."
    )
    losses.update({Site.PELVIS: 0.02, Site.LEFT_FOOT: 0.0}, 12.0)
    assert losses.message(True, [*ALL, *HIPS], 12.5) == (
        "Pelvis: signal back after 3.1 s.",
        "Only hip angles are missing in between.",
    )


def test_a_silent_thigh_costs_its_knee_and_its_hip() -> None:
    losses = Losses()
    losses.update({Site.LEFT_THIGH: 3.1, Site.PELVIS: 0.0}, 10.0)
    assert losses.message(True, [*ALL, *HIPS], 11.0)[1] == (
        "Recording continues. Missing until the signal is back: left knee, left hip."
    )


def test_a_pelvis_that_is_silent_with_a_foot_is_one_of_two() -> None:
    losses = Losses()
    losses.update({Site.LEFT_FOOT: 3.1, Site.PELVIS: 3.1, Site.RIGHT_FOOT: 0.0}, 10.0)
    what, then = losses.message(True, [*ALL, *HIPS], 11.0)
    assert what == "L foot, pelvis: no signal for 3 s."
    assert then.endswith("left ankle, left hip, right hip, left gait phases.")

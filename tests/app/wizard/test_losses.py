"""Silent sensors: told after two seconds, with what they cost, and once more when they are back."""

from app.wizard.losses import NOTHING, Losses
from core.body import LEG_JOINTS, LEG_SITES, Site

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
        "R foot has been silent for 3 s.",
        "Recording goes on. Missing until it is back: right ankle, right phases.",
    )


def test_between_walks_it_says_what_to_do() -> None:
    losses = Losses()
    losses.update({Site.LEFT_SHANK: 4.2}, 10.0)
    assert losses.message(False, ALL, 10.0) == (
        "L shank has been silent for 4 s.",
        "Switch it off and on, or go on without these angles: left knee, left ankle.",
    )


def test_its_return_is_told_with_how_long_it_was() -> None:
    losses = Losses()
    losses.update({Site.RIGHT_FOOT: 3.1}, 10.0)
    losses.update({Site.RIGHT_FOOT: 0.02}, 10.1)
    assert losses.message(True, ALL, 11.0) == (
        "R foot is back after 3.1 s.",
        "The strides in between are left out.",
    )
    assert losses.message(True, ALL, 20.0) == NOTHING


def test_a_sensor_worn_no_more_is_forgotten() -> None:
    losses = Losses()
    losses.update({Site.RIGHT_FOOT: 3.1}, 10.0)
    losses.update({}, 10.1)
    assert losses.message(True, ALL, 10.1) == NOTHING


def test_two_are_told_together() -> None:
    losses = Losses()
    losses.update({Site.RIGHT_FOOT: 3.1, Site.LEFT_FOOT: 5.0, Site.LEFT_SHANK: 0.0}, 10.0)
    assert losses.message(True, [], 10.0) == (
        "L foot, R foot have been silent for 5 s.",
        "Recording goes on. Missing until they are back: left phases, right phases.",
    )
    assert losses.message(False, [], 10.0)[1] == "Switch them off and on, or go on without them."


def test_where_none_is_heard_the_receiver_is_told_of_and_their_return_is_told_together() -> None:
    losses = Losses()
    losses.update(dict.fromkeys(LEG_SITES, 3.0), 10.0)
    then = "Check that the receiver is plugged in and near the patient, and the sensors are switched on."
    assert losses.message(False, ALL, 10.0) == ("No sensor has been heard for 3 s.", then)
    assert losses.message(True, ALL, 10.0)[1] == f"Recording goes on. {then}"
    losses.update({**dict.fromkeys(LEG_SITES, 0.02), Site.LEFT_FOOT: 3.5}, 10.5)
    losses.update(dict.fromkeys(LEG_SITES, 0.02), 11.0)
    assert losses.message(True, ALL, 11.0)[0] == "All sensors are back after 3.5 s."
    losses.update({**dict.fromkeys(LEG_SITES, 0.02), Site.LEFT_FOOT: 2.1}, 20.0)
    losses.update(dict.fromkeys(LEG_SITES, 0.02), 20.5)
    assert losses.message(True, ALL, 20.5)[0] == "L foot is back after 2.1 s."

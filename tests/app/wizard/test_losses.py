"""Silent sensors: reported after two seconds, with what they cost, and once more when they are back."""

from collections.abc import Mapping, Sequence

from syrupy.assertion import SnapshotAssertion

from app.wizard.losses import NOTHING, Losses
from core.body import LEG_JOINTS, LEG_SITES, Joint, Site

ALL = list(LEG_JOINTS)
WITH_HIPS = [*ALL, Joint.LEFT_HIP, Joint.RIGHT_HIP]
ALL_BACK = dict.fromkeys(LEG_SITES, 0.02)


def stated(
    *silent: Mapping[Site, float], joints: Sequence[Joint] = ALL, now_s: float = 11.0
) -> dict[str, tuple[str, str]]:
    """What is stated once sensors were silent for so many seconds, at 10 s, half a second later and so on."""
    losses = Losses()
    for count, one in enumerate(silent):
        losses.update(one, 10.0 + 0.5 * count)
    return {
        "amid a walk": losses.message(True, joints, now_s),
        "between walks": losses.message(False, joints, now_s),
    }


def test_a_silent_sensor_is_news_once() -> None:
    losses = Losses()
    assert losses.update({Site.RIGHT_FOOT: 1.9}, 9.0) == ()
    assert losses.message(True, ALL, 9.0) == NOTHING  # a short silence is nobody's business
    assert losses.update({Site.RIGHT_FOOT: 2.1}, 10.0) == (Site.RIGHT_FOOT,)
    assert losses.update({Site.RIGHT_FOOT: 3.1}, 11.0) == ()
    assert losses.update({Site.RIGHT_FOOT: 3.1, Site.PELVIS: 3.1}, 12.0) == (Site.PELVIS,)


def test_a_silence_states_what_it_costs_and_what_to_do(snapshot: SnapshotAssertion) -> None:
    assert {
        "a foot": stated({Site.RIGHT_FOOT: 3.1}),
        "a shank": stated({Site.LEFT_SHANK: 4.2}),
        "two are reported together": stated(
            {Site.RIGHT_FOOT: 3.1, Site.LEFT_FOOT: 5.0, Site.LEFT_SHANK: 0.0}, joints=()
        ),
        "where none is received it is the receiver": stated(dict.fromkeys(LEG_SITES, 3.0)),
        "a pelvis costs the hips, and the rest goes on": stated(
            {Site.PELVIS: 3.1, Site.LEFT_FOOT: 0.0}, joints=WITH_HIPS
        ),
        "a thigh costs its knee and its hip": stated({Site.LEFT_THIGH: 3.1, Site.PELVIS: 0.0}, joints=WITH_HIPS),
        "a pelvis that is silent with a foot is one of two": stated(
            {Site.LEFT_FOOT: 3.1, Site.PELVIS: 3.1, Site.RIGHT_FOOT: 0.0}, joints=WITH_HIPS
        ),
    } == snapshot


def test_a_return_is_reported_for_a_while_with_how_long_it_was(snapshot: SnapshotAssertion) -> None:
    foot = {Site.RIGHT_FOOT: 3.1}, {Site.RIGHT_FOOT: 0.02}
    every = dict.fromkeys(LEG_SITES, 3.0), ALL_BACK | {Site.LEFT_FOOT: 3.5}, ALL_BACK
    assert {
        "a foot": stated(*foot),
        "ten seconds later": stated(*foot, now_s=20.5),
        "one that is worn no more is forgotten": stated(foot[0], {}),
        "all are reported together": stated(*every, now_s=11.5),
        "of one that was silent later, it alone": stated(
            *every, *[ALL_BACK] * 15, ALL_BACK | {Site.LEFT_FOOT: 2.1}, ALL_BACK, now_s=19.5
        ),
        "the pelvis": stated(
            {Site.PELVIS: 3.1, Site.LEFT_FOOT: 0.0}, {Site.PELVIS: 0.02, Site.LEFT_FOOT: 0.0}, joints=WITH_HIPS
        ),
    } == snapshot

"""Tests that the demonstration's user of a prosthesis walks as stated by the settings."""

import time

import numpy as np
import pytest

from core.alignment import NetChange, ProsthesisPart
from core.body import Side
from core.samples import ImuBlock
from core.session import RecordingKind
from devices.simulation.fitted_prosthesis import BUILT, DEG_PER_TURN, setting_of
from devices.simulation.prosthesis_user import ProsthesisUser
from devices.simulation.replay import DEMONSTRATION_NAMES
from devices.simulation.walker import FreeMotion, Standing, WalkerSettings

FAST = 40.0
SITES = {name: site for site, name in DEMONSTRATION_NAMES.items()}


def patient() -> ProsthesisUser:
    few = WalkerSettings(seed=1, recordings=(Standing(duration_s=4.0), FreeMotion(duration_s=6.0)))
    return ProsthesisUser(Side.RIGHT, few, speed=FAST)


def received(user: ProsthesisUser, kind: RecordingKind, seconds: float) -> dict[str, list[ImuBlock]]:
    """What is sent in so many of its seconds after it was asked."""
    user.ask(kind)
    blocks: dict[str, list[ImuBlock]] = {}
    end_s = time.monotonic() + seconds / FAST
    while time.monotonic() < end_s:
        for block in user.read(lambda *_: None):
            blocks.setdefault(block.sensor, []).append(block)
    return blocks


def swing_of(blocks: dict[str, list[ImuBlock]]) -> float:
    """How fast the prosthetic shank turns at most, a stand-in for how far the knee swings, rad/s."""
    shank = next(name for name, site in SITES.items() if site == "right_shank")
    rate = np.linalg.norm(np.concatenate([block.gyr_rad_s for block in blocks[shank]]), axis=1)
    return float(np.sort(rate)[-40:].mean())


def test_what_is_turned_is_what_moves() -> None:
    changes = {
        ProsthesisPart.FOOT_FRONT_SCREW: NetChange(ProsthesisPart.FOOT_FRONT_SCREW, 2.0, 0.5, 4.0),
        ProsthesisPart.FOOT_BACK_SCREW: NetChange(ProsthesisPart.FOOT_BACK_SCREW, 1.0),
        ProsthesisPart.PYLON: NetChange(ProsthesisPart.PYLON, height_mm=3.0),
        ProsthesisPart.KNEE_UNIT: NetChange(ProsthesisPart.KNEE_UNIT, angle_deg=2.0, turns=1.5),
        ProsthesisPart.SHOE: NetChange(ProsthesisPart.SHOE, angle_deg=9.0, height_mm=20.0, done=("other shoe",)),
    }
    found = setting_of(changes)
    assert (found.plantar_deg, found.back_mm, found.height_mm, found.stop_deg) == (3.0, 4.0, 3.0, 2.0)
    assert found.swing_flexion_deg == BUILT.swing_flexion_deg + 1.5 * DEG_PER_TURN
    assert setting_of({}) == BUILT


@pytest.mark.endurance
@pytest.mark.parametrize("turns", [-2.0, 2.0])
def test_the_walk_after_a_change_is_walked_so(turns: float) -> None:
    user = patient()
    user.open()
    before = swing_of(received(user, RecordingKind.WALKING, 40 + FAST))  # and a second to make it in
    user.ask(None)
    user.set_up([NetChange(ProsthesisPart.KNEE_UNIT, turns=turns)])
    after = swing_of(received(user, RecordingKind.WALKING, 40 + 2 * FAST))
    assert before > 3.0
    assert np.sign(after - before) == np.sign(turns)
    assert abs(after - before) > 0.3
    user.close()


@pytest.mark.endurance
def test_who_was_reported_to_stop_meanwhile_does_not_walk() -> None:
    user = patient()
    user.open()
    user.ask(RecordingKind.WALKING)
    user.ask(None)
    blocks: dict[str, list[ImuBlock]] = {}
    end_s = time.monotonic() + 1.5
    while time.monotonic() < end_s:
        for block in user.read(lambda *_: None):
            blocks.setdefault(block.sensor, []).append(block)
    assert swing_of(blocks) < 1.0
    user.close()


def test_it_is_asked_without_waiting() -> None:
    """The screen's thread asks; the walk is made beside it."""
    user = patient()
    user.open()
    begin_s = time.monotonic()
    assert user.ask(RecordingKind.WALKING) is None
    user.set_up(())
    user.ask(None)
    assert time.monotonic() - begin_s < 0.1
    user.close()

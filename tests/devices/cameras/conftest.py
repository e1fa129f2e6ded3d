"""A capture that is stopped after its test."""

from collections.abc import Callable, Iterator

import pytest

from devices.cameras.camera import CameraInfo, CameraMode
from devices.cameras.capture import Capture
from tests.devices.cameras.stand_ins import Taken
from tests.waiting import PATIENCE_S

ASKED = CameraMode()


@pytest.fixture
def begin(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., tuple[Capture, Taken]]]:
    begun: list[Capture] = []
    monkeypatch.setattr("devices.cameras.capture.LEAVES_S", PATIENCE_S)

    def begin(info: CameraInfo, mode: CameraMode = ASKED, **limits: float) -> tuple[Capture, Taken]:
        taken = Taken()
        limits = {"silent_s": PATIENCE_S, "opens_s": PATIENCE_S} | limits  # a busy machine silences no camera
        one = Capture(info, mode, taken.frames.append, taken.ends.append, taken.modes.append, **limits)
        begun.append(one)
        return one, taken

    yield begin
    for one in begun:
        one.stop()
        assert one.process.poll() is not None

"""Tests that cameras are found where there are some, and that nothing is where the library is missing."""

import os
import sys
from pathlib import Path

import pytest

from devices.cameras import finding
from devices.cameras.camera import V4L2, CameraInfo
from devices.cameras.finding import cameras_in, find_cameras, why_no_cameras

on_linux = pytest.mark.skipif(sys.platform != "linux", reason="cameras of Linux")


def device(place: Path, number: int, name: str, index: int) -> None:
    folder = place / "sys" / f"video{number}"
    folder.mkdir(parents=True)
    (folder / "name").write_text(f"{name}\n")
    (folder / "index").write_text(f"{index}\n")
    (place / "dev").mkdir(exist_ok=True)
    (place / "dev" / f"video{number}").touch()


@on_linux
def test_of_the_devices_of_a_camera_the_one_that_takes_pictures_is_found(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for number, name, index in (
        (10, "Logi", 0),
        (2, "Built-in: camera", 0),
        (3, "Built-in: camera", 1),
        (4, "Tuner", 0),
    ):
        device(tmp_path, number, name, index)
    abilities = {2: 0x04200001, 3: 0x04A00000, 4: 0x05, 10: 0x04201000}  # 3 gives metadata only
    opened: dict[int, int] = {}

    def ioctl(descriptor: int, request: int, answer: bytes) -> bytes:
        assert request == finding.QUERY
        number = int(Path(f"/proc/self/fd/{descriptor}").readlink().name.removeprefix("video"))
        opened[number] = descriptor
        if number == 4:
            raise OSError(25, "Inappropriate ioctl for device")
        return answer[:88] + abilities[number].to_bytes(4, "little") + answer[92:]

    monkeypatch.setattr("fcntl.ioctl", ioctl)
    assert cameras_in(tmp_path / "sys", tmp_path / "dev") == (
        CameraInfo("Built-in: camera", str(tmp_path / "dev" / "video2"), V4L2),
        CameraInfo("Logi", str(tmp_path / "dev" / "video10"), V4L2),
    )
    assert set(opened) == {2, 3, 4, 10}
    for descriptor in opened.values():
        with pytest.raises(OSError, match="Bad file descriptor"):
            os.fstat(descriptor)


@on_linux
@pytest.mark.skipif(getattr(os, "geteuid", int)() == 0, reason="everything may be opened by root")
def test_a_camera_that_may_not_be_opened_is_found_so_that_starting_it_can_say_why(tmp_path: Path) -> None:
    device(tmp_path, 0, "Webcam", 0)
    device(tmp_path, 1, "Webcam", 1)
    for number in (0, 1):
        (tmp_path / "dev" / f"video{number}").chmod(0)
    assert [one.place for one in cameras_in(tmp_path / "sys", tmp_path / "dev")] == [str(tmp_path / "dev" / "video0")]


def test_no_folder_of_cameras_is_no_camera(tmp_path: Path) -> None:
    assert cameras_in(tmp_path / "sys", tmp_path / "dev") == ()


def test_without_the_library_there_is_no_camera_and_a_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    assert why_no_cameras() is None
    monkeypatch.setattr(finding, "find_spec", lambda _: None)
    assert find_cameras() == ()
    reason = why_no_cameras()
    assert reason is not None
    assert str(reason) == "Cameras cannot be used: a software library is missing. Install gaitwright[video]."


def test_elsewhere_the_systems_list_is_asked_by_a_process_of_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(finding, "PLATFORM", "win32")
    assert find_cameras() == ()  # this machine has no DirectShow: the process says so by its end
    monkeypatch.setattr(finding, "LISTS", {"win32": "lavfi"})
    assert find_cameras() == ()  # a list that is empty

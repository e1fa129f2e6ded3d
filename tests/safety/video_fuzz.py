"""T13: spoilt videos.

Check whether one ends or hangs the reading process, writes anywhere, or raises anything but a refusal.

    python -m tests.safety.video_fuzz --files 200

Each video is damaged as in `file_fuzz`: bits, bursts, blocks, cut, doubled, or replaced by a link that leads outside.
An MP4 with its description first, a MOV with it last, and a WebM; each is read from its start and from its middle.
"""

import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path

from devices.files.limited_reader import LimitedReader, LimitedReading
from tests.devices.files.videos import FASTSTART, write_video
from tests.driver import drive
from tests.safety.file_fuzz import Spoilable, fuzz_each, nobody

FRAMES = 30


def read_of(name: str) -> Callable[[LimitedReader, Path], object]:
    """Reads its first half, then from the middle."""

    def read(reader: LimitedReader, folder: Path) -> object:
        reading = LimitedReading(reader, nobody)
        first = reading.read_video(folder / name, 0.0, FRAMES // 2)
        return first, reading.read_video(folder / name, 0.5, FRAMES)

    return read


@cache
def videos() -> dict[str, Spoilable]:
    found = {}
    with tempfile.TemporaryDirectory() as place:
        for name, codec, options in (
            ("a.mp4", "libx264", FASTSTART),
            ("b.mov", "libx264", None),
            ("c.webm", "libvpx-vp9", None),
        ):
            path = write_video(Path(place) / name, FRAMES, codec, (160, 90), options)
            found[name] = Spoilable(path.read_bytes(), name, read_of(name), may_be_a_link=True)
    return found


if __name__ == "__main__":
    drive(
        __doc__,
        lambda asked, _: fuzz_each(videos(), asked.files, asked.seed, asked.video),
        files=200,
        seed=1,
        video={"choices": tuple(videos()), "action": "append"},
    )

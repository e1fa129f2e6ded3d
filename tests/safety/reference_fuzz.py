"""T13 for references:

spoilt files of optical systems. Check whether one ends or hangs the application, or writes anywhere.

    python -m tests.safety.reference_fuzz --files 10000

As `file_fuzz` does it for recordings, by the same process.
"""

import tempfile
from pathlib import Path

import ezc3d
import numpy as np

from devices.files.limited_reader import LimitedReader, LimitedReading
from tests.driver import drive
from tests.safety.file_fuzz import Spoilable, fuzz_each, nobody

FRAMES = 30


def read_it(reader: LimitedReader, folder: Path) -> object:
    return LimitedReading(reader, nobody).read_reference(folder / "reference")


def plain_csv() -> bytes:
    rows = (f"walk {1 + k // 15},{k % 15 / 100:.2f},{20 + k},{k / 7:.3f}" for k in range(FRAMES))
    return "\n".join(["recording,time_s,left_knee,right_ankle", *rows, ""]).encode()


def opensim() -> bytes:
    rows = (f"{k / 100:.3f}\t{20 + k}\t{k / 7:.3f}" for k in range(FRAMES))
    head = ["Coordinates", "version=1", "inDegrees=yes", "endheader", "time\tknee_angle_r\tankle_angle_l"]
    return "\n".join([*head, *rows, ""]).encode()


def visual3d() -> bytes:
    columns = (("", "", "", "", "ITEM"), ("a.c3d", "TIME", "F", "O", "X"), ("a.c3d", "RKneeAngle", "L", "O", "X"))
    rows = (f"{k + 1}\t{k / 100:.3f}\t{20 + k}" for k in range(FRAMES))
    return "\n".join([*("\t".join(row) for row in zip(*columns, strict=True)), *rows, ""]).encode()


def c3d() -> bytes:
    made = ezc3d.c3d()
    made["parameters"]["POINT"]["RATE"]["value"] = [100.0]
    made["parameters"]["POINT"]["LABELS"]["value"] = ["LKneeAngles", "RAnkleAngles"]
    made["data"]["points"] = np.ones((4, 2, FRAMES))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "made.c3d"
        made.write(str(path))
        return path.read_bytes()


def reference_readers() -> dict[str, Spoilable]:
    made = {"csv": plain_csv(), "opensim": opensim(), "visual3d": visual3d(), "c3d": c3d()}
    return {name: Spoilable(content, "reference", read_it, may_be_a_link=False) for name, content in made.items()}


if __name__ == "__main__":
    drive(__doc__, lambda asked, _: fuzz_each(reference_readers(), asked.files, asked.seed), files=500, seed=1)

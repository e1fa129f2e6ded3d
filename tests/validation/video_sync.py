"""How well a video finds its place among the samples by what moves, on simulated walks before a drawn camera.

    python -m tests.validation.video_sync [--first 100] [--cases 40]

Live cameras: the offset is searched from -0.45 to 0.05 s; each is tried once more with one beyond that. Files: over all
that overlaps. A case is right within two frames of a camera at 30/s (67 ms), badly wrong beyond four; certain is what
an offset is reported of. Cases 0 to 22 are those that the limits were chosen on. Every tenth person is standing still,
every tenth file is of another walk: an offset that is reported of these is false.

Cases 100 to 144, live: 27 of 41 certain, 26 of these within 67 ms, the other at 74 (median +3 ms, RMS 28), 0 of 4
false; of later cameras 1 of 41 certain and wrong. Files: 15 of 36 certain, 14 of these within 67 ms, the other at 75
(RMS 33); 2 of 9 false, both of somebody who walks as many strides as the one with the sensors, in the same manner.
"""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from core.video.synchronising import LIVE_SEARCH_S, WHOLE_SEARCH_S, picture_motion, sync_from_motion
from tests.driver import options
from tests.validation.video_cases import BEYOND_S, TROUBLES, VideoCase, draw_case, video_of, walked

RIGHT_S, BADLY_WRONG_S = 2 / 30, 4 / 30


@dataclass(slots=True)
class SyncScore:
    """What came of the cases of one kind."""

    cases: int = 0
    errors_s: list[float] = field(default_factory=list)
    sd_s: list[float] = field(default_factory=list)
    not_to_be_found: int = 0
    beyond: int = 0
    beyond_wrong: int = 0
    false: list[VideoCase] = field(default_factory=list)
    certain_of: Counter[str] = field(default_factory=Counter)
    wrong: list[str] = field(default_factory=list)

    def add(self, case: VideoCase) -> None:
        video = video_of(case)
        imu = walked(case.person, case.number).session.recordings[0].imu
        search_s = WHOLE_SEARCH_S if case.is_imported else LIVE_SEARCH_S
        motion = picture_motion(video.grey, video.time_s)
        sync = sync_from_motion(video.time_s, motion, imu, search_s=search_s)
        if not case.is_imported and case.is_right:
            self.beyond += 1
            later_s = float(np.random.default_rng([case.number, 9]).uniform(*BEYOND_S))
            later = sync_from_motion(video.time_s + case.offset_s - later_s, motion, imu, search_s=search_s)
            self.beyond_wrong += later is not None and abs(later.offset_s - later_s) > RIGHT_S
        if not case.is_right:
            self.not_to_be_found += 1
            if sync is not None:
                self.false.append(case)
            return
        self.cases += 1
        if sync is None:
            return
        error_s = sync.offset_s - case.offset_s
        self.errors_s.append(error_s)
        self.sd_s.append(sync.sd_s)
        self.certain_of[case.trouble] += 1
        if abs(error_s) > RIGHT_S:
            self.wrong.append(f"{case.number} {case.person}, {case.trouble}, {case.view}: {error_s:+.3f} s")

    def __str__(self) -> str:
        errors_s = np.array(self.errors_s)
        certain = len(errors_s)
        median_ms, rms_ms = (1e3 * np.median(errors_s), 1e3 * np.sqrt(np.mean(errors_s**2))) if certain else (0.0, 0.0)
        lines = [f"{certain} of {self.cases} certain"]
        if certain:
            lines += [
                f"{np.count_nonzero(np.abs(errors_s) <= RIGHT_S)} of them within 67 ms, "
                f"{np.count_nonzero(np.abs(errors_s) > BADLY_WRONG_S)} beyond 133 ms",
                f"error {median_ms:+.0f} ms in the median, RMS {rms_ms:.0f}",
                f"median SD reported {1e3 * np.median(self.sd_s):.0f} ms",
            ]
        lines.append(f"{len(self.false)} of {self.not_to_be_found} false")
        if self.beyond:
            lines.append(f"{self.beyond_wrong} of {self.beyond} that come later than is searched certain and wrong")
        lines.append("certain by trouble: " + ", ".join(f"{name} {self.certain_of[name]}" for name in TROUBLES))
        return "; ".join(lines)


def score(numbers: Iterable[int], *, is_imported: bool) -> SyncScore:
    """Synchronise every case."""
    total = SyncScore()
    for number in numbers:
        total.add(draw_case(number, is_imported=is_imported))
        walked.cache_clear()
    return total


if __name__ == "__main__":
    asked = options(__doc__, first=100, cases=40)
    for kind in (False, True):
        found = score(range(asked.first, asked.first + asked.cases), is_imported=kind)
        print("files:" if kind else "live:", found, flush=True)
        print(
            *(f"  wrong: {one}\n" for one in found.wrong), *(f"  false: {one}\n" for one in found.false), sep="", end=""
        )

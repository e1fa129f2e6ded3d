"""Time from a move of the cursor until the clip's frame is painted, and what playing costs.

    python -m tests.benchmarks.video_cursor [--moves 200] [--width 1280] [--height 720]

A clip of a simulated walk (JPEG, 30/s) beside its curves in a page of 1064 x 672, Qt's offscreen screen. The cursor
goes to places drawn at random; of each the time until the frame is painted, how long the window did not answer, and
processor time of its thread, ms: on a busy machine the last alone is the work that it takes.
"""

import os
from statistics import quantiles
from time import perf_counter, process_time, thread_time

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

import numpy as np
from PySide6.QtCore import QEventLoop
from PySide6.QtWidgets import QApplication

from app.results.result_page import ResultPage
from app.theme.current import load_fonts, set_theme
from app.theme.theme import Theme
from tests.app.drawn_clips import drawn_clip
from tests.app.results.test_video_page import visit
from tests.driver import options

PLAYED_S = 10.0


def main() -> None:
    args = options(__doc__, moves=200, width=1280, height=720)
    application = QApplication([])
    load_fonts()
    set_theme(Theme())
    page = ResultPage()
    page.set_room(1064, 672)
    page.resize(1064, 672)
    page.show_visit(visit())
    clip = drawn_clip(visit().walk("walk 1"), size=(args.width, args.height))
    page.show_clips([clip])
    page.recordings.setCurrentIndex(page.recordings.findData("walk 1"))
    page.show()
    page.show_video.click()
    player = page.video.player
    painted: list[int] = []
    player.painted.connect(painted.append)
    _pump(application, 1.0)

    taken_ms, held_ms, worked_ms = [], [], []
    places = np.random.default_rng(0).uniform(1.0, float(clip.time_s[-1]) - 1.0, args.moves)
    for time_s in places.tolist():
        painted.clear()
        begun_s, worked_s = perf_counter(), thread_time()
        page.video.move_to(time_s)
        longest_s, last_s = perf_counter() - begun_s, perf_counter()
        while not painted and player.shown_frame != player.frame:
            application.processEvents(QEventLoop.ProcessEventsFlag.AllEvents)
            longest_s, last_s = max(longest_s, perf_counter() - last_s), perf_counter()
        if painted:  # else the same frame is in sight
            taken_ms.append(1000 * (perf_counter() - begun_s))
            held_ms.append(1000 * longest_s)
            worked_ms.append(1000 * (thread_time() - worked_s))
    print(f"{len(taken_ms)} frames; kB each: {len(clip.pictures.jpeg(0)) / 1000:.0f}")
    for name, values in (("move to painted, ms", taken_ms), ("window held, ms", held_ms), ("its work, ms", worked_ms)):
        steps = quantiles(values, n=20)
        print(f"{name}: median {steps[9]:.1f}, p95 {steps[18]:.1f}, worst {max(values):.1f}")

    painted.clear()
    page.video.transport.speeds.choose("whole")
    page.video.move_to(1.0)
    cpu_s = process_time()
    page.video.turn()
    _pump(application, PLAYED_S)
    print(f"played at 1x: {len(painted) / PLAYED_S:.1f} frames/s, {(process_time() - cpu_s) / PLAYED_S:.0%} of a core")
    page.video.stop()
    page.close()


def _pump(application: QApplication, for_s: float) -> None:
    until_s = perf_counter() + for_s
    while (left_s := until_s - perf_counter()) > 0:
        application.processEvents(QEventLoop.ProcessEventsFlag.WaitForMoreEvents, max(1, int(1000 * left_s)))


if __name__ == "__main__":
    main()

"""What the examples and README's Python print, run on simulated sessions as their tests run them.

`python packaging/site_examples.py PAGES` adds it, with the figures that the examples draw, to the pages that
`site_pages` has put there. It takes the application's environment, and half a minute.
"""

import io
import os
import re
import runpy
import sys
import tempfile
from collections.abc import Callable, Mapping
from contextlib import chdir, redirect_stdout
from dataclasses import replace
from importlib import import_module
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
FIGURE = Path("figure.png")
WHAT = {
    "one_leg": "the left leg of a simulated patient: standing, free motion and a walk",
    "two_walks": "both legs of a simulated patient: standing, free motion, a slow and a fast walk",
    "course": "a simulated patient who gets up, walks, turns and sits down again",
    "demonstration": "the simulated patient of the demonstration",
}
# the arguments of each example as on its page, and what they hold; what is missing needs a sensor
RUNS: Mapping[str, tuple[str, str]] = {
    "analyse_a_folder": ("one_leg", WHAT["one_leg"]),
    "angles_as_a_frame": (f"two_walks {FIGURE}", WHAT["two_walks"]),
    "axes_of_a_joint": (f"two_walks {FIGURE}", WHAT["two_walks"]),
    "compare_walks": (f"two_walks {FIGURE}", WHAT["two_walks"]),
    "error_statistics": (f"{FIGURE} 5", "five simulated people"),
    "events_of_one_foot": ("one_leg", WHAT["one_leg"]),
    "export_tables": ("two_walks tables", WHAT["two_walks"]),
    "look_at_a_session": (f"two_walks {FIGURE}", WHAT["two_walks"]),
    "mean_cycle": (f"two_walks {FIGURE}", WHAT["two_walks"]),
    "new_file_format": ("thigh.csv shank.csv session", "files with a gap of three samples"),
    "new_sensor": ("sent.bin", "300 frames, of which two are lost and one is damaged"),
    "own_sensor_positions": (f"samples.npz {FIGURE}", WHAT["two_walks"]),
    "published_method": ("one_leg", WHAT["one_leg"]),
    "simulate_and_compare": (f"{FIGURE}", "a simulated patient"),
    "timed_test": (f"course {FIGURE}", WHAT["course"]),
}
WITHOUT = {
    "live_from_a_port": "It needs a sensor at a serial port, so its output is not shown here.",
    "live_lsl": "It needs a walk that Gaitwright streams meanwhile, so its output is not shown here.",
}
README_OUTPUT = "<!-- output of README -->"


def main(pages: Path) -> None:
    os.environ.setdefault("MPLBACKEND", "agg")
    sys.path[:0] = [str(ROOT)]  # its tests are in no package
    with tempfile.TemporaryDirectory() as place, chdir(place):
        write_sessions()
        for name in RUNS:
            add_output(pages / "examples", name)
        for name, why in WITHOUT.items():
            file = pages / "examples" / f"{name}.md"
            file.write_text(f"{file.read_text(encoding='utf-8')}\n## Output\n\n{why}\n", encoding="utf-8")
        page = pages / "python.md"
        printed = shown(output_of(lambda: runpy.run_path(str(written_readme_lines()))))
        page.write_text(page.read_text(encoding="utf-8").replace(README_OUTPUT, printed), encoding="utf-8")


def write_sessions() -> None:
    """Write what the examples read into the present folder."""
    from core.body import Site
    from devices.files.session_folder import write_session
    from devices.simulation.walker import DEMONSTRATION, simulate
    from tests import example_sessions as some

    one_leg, two_walks = simulate(some.ONE_LEG), simulate(some.TWO_WALKS)
    write_session(one_leg.session, Path("one_leg"))
    write_session(two_walks.session, Path("two_walks"))
    write_session(some.up_and_go(), Path("course"))
    write_session(simulate(DEMONSTRATION).session, Path("gaitwright-demo", "session"))
    for name, site in {"thigh": Site.LEFT_THIGH, "shank": Site.LEFT_SHANK}.items():
        some.write_counted_lines(some.last_block(one_leg, site), Path(f"{name}.csv"))
    Path("sent.bin").write_bytes(some.frames_of_new_sensor())
    some.write_own_arrays(replace(two_walks, moved=()), Path("samples.npz"))


def add_output(pages: Path, name: str) -> None:
    """Run an example and add what it prints and draws to its page."""
    arguments, what = RUNS[name]
    example = import_module(f"tests.examples.{name}").main
    taken = [int(one) if one.isdigit() else Path(one) for one in arguments.split()]
    printed = output_of(lambda: example(*taken))
    text = f"\n## Output\n\nOf `python -m tests.examples.{name} {arguments}`, on {what}:\n\n{shown(printed)}\n"
    for figure in (FIGURE, Path("tables", "cycles.png")):
        if figure.exists():
            (pages / "figures").mkdir(exist_ok=True)
            figure.replace(pages / "figures" / f"{name}.png")
            text += f"\n![The figure that this example draws](figures/{name}.png)\n"
    file = pages / f"{name}.md"
    file.write_text(file.read_text(encoding="utf-8") + text, encoding="utf-8")


def written_readme_lines() -> Path:
    (lines,) = re.findall(r"(?s)```python\n(.*?)```", (ROOT / "README.md").read_text(encoding="utf-8"))
    script = Path("lines.py")
    script.write_text(lines, encoding="utf-8")
    return script


def output_of(run: Callable[[], object]) -> str:
    with redirect_stdout(io.StringIO()) as printed:
        run()
    return printed.getvalue()


def shown(printed: str) -> str:
    return f"```text\n{printed.rstrip()}\n```"


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve())

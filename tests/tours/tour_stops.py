"""Stops of a tour: where it stops, what the screen must show there, and what is done.

By keyboard, by mouse, at the bench, and with a seventh sensor on the pelvis.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

PATIENCE_S = 30.0


@dataclass(frozen=True, slots=True)
class Seen:
    """What the application reports itself: screen and step by their classes, the control that has the focus, and the
    enabled controls in sight by their accessible names, each with its middle on the display. All in English, too,
    whatever is spoken; a word that may stand for several is there as each of them."""

    screen: str
    step: str
    focus: tuple[str, ...]
    is_recording: bool
    banner: str
    stopwatch_s: float
    words: tuple[str, ...]
    controls: Mapping[str, tuple[int, int]]

    def has(self, control: str) -> bool:
        return any(name.startswith(control) for name in self.controls)

    def states(self, words: str) -> bool:
        return any(words in text for text in self.words)


@dataclass(frozen=True, slots=True)
class Stop:
    """One place of the tour.

    Attributes
    ----------
    name
        Of its pictures.
    until
        What the screen must say before anything is done.
    does
        One after the other: "press Return" (keys as xdotool names them), "type P-1" ("{home}" is the tour's own
        folder), "copy key" (types the end of the recovery key shown), "to Stop" (presses Tab until a control whose name
        begins with Stop has the focus), "click Stop", "drag 0A09 to L thigh", "await Rerun" (another program's window,
        by its title), "raise Gaitwright" (before all others).
    lingers_s
        Before the pictures, for what moves.
    is_counted
        Whether keys and clicks here count as what the session takes.
    leaves
        Files of the tour's own folder, by a pattern, and words that one of them must hold then.
    """

    name: str
    until: Callable[[Seen], bool]
    does: tuple[str, ...] = ()
    lingers_s: float = 0.5
    patience_s: float = PATIENCE_S
    leaves: tuple[tuple[str, str], ...] = ()
    is_counted: bool = False


def at(screen: str) -> Callable[[Seen], bool]:
    return lambda seen: seen.screen == screen


def at_step(step: str) -> Callable[[Seen], bool]:
    return lambda seen: seen.screen == "Wizard" and seen.step == step


def offers(*controls: str) -> Callable[[Seen], bool]:
    return lambda seen: all(seen.has(control) for control in controls)


def states(words: str) -> Callable[[Seen], bool]:
    return lambda seen: seen.states(words)


def focus_on(control: str) -> Callable[[Seen], bool]:
    return lambda seen: any(name.startswith(control) for name in seen.focus)


def shows_pages(seen: Seen) -> bool:
    return at_step("ReportStep")(seen) and any(words.endswith(" pages") for words in seen.words)


def compares(letter: str) -> Callable[[Seen], bool]:
    """Whether the bench gives what a walk that waits to be kept is like, and not that it is being analysed."""
    named = re.compile(rf"\b(with|mit) {letter}\b")
    return lambda seen: seen.has(f"Include {letter}") and any(map(named.search, seen.words))


def is_recording(seen: Seen) -> bool:
    return seen.is_recording


def has_walked(strides: int) -> Callable[[Seen], bool]:
    """Whether so many strides are counted of the walk that is being recorded."""

    def counted(seen: Seen) -> bool:
        if not seen.is_recording or "Strides" not in seen.words:
            return False
        behind = seen.words[seen.words.index("Strides") :]
        count = behind[1] if len(behind) > 1 else ""  # a dash while it is not known
        return count.isdigit() and int(count) >= strides

    return counted


PASSPHRASE = "seven quiet herons cross"
STRIDES = 13  # the simulated patient takes 14 steps with each foot
PLACES = {
    "DEMO-09": "L thigh",
    "DEMO-17": "R thigh",
    "DEMO-1B": "R shank",
    "DEMO-22": "R foot",
    "DEMO-2C": "L foot",
    "DEMO-31": "L shank",
}
DIGITS = {"L thigh": 1, "L shank": 2, "L foot": 3, "R thigh": 4, "R shank": 5, "R foot": 6}
PLACED_BY_KEYS = tuple(key for place in PLACES.values() for key in (f"press {DIGITS[place]}", "press Down"))
PLACED_BY_MOUSE = tuple(f"drag {sensor} to {place}" for sensor, place in PLACES.items())


def walk(number: int, starts: tuple[str, ...], stops: str) -> tuple[Stop, ...]:
    """Give the stops of one walk."""
    return (
        Stop(f"{number + 9:02d}a-choose", offers("Barefoot"), starts, lingers_s=1.0, patience_s=90.0),
        Stop(f"{number + 9:02d}b-walking", has_walked(6), patience_s=60.0),
        Stop(f"{number + 9:02d}c-walked", has_walked(STRIDES), (stops,), patience_s=60.0),
    )


KEYBOARD: tuple[Stop, ...] = (
    Stop(
        "01-first-start",
        at("FirstStartPage"),
        (
            "type TM",
            "press Tab",
            "type Tour Guide",
            "press Tab",
            f"type {PASSPHRASE}",
            "press Tab",
            f"type {PASSPHRASE}",
        ),
    ),
    Stop("02-typed", at("FirstStartPage"), ("press Return",)),
    Stop("03-recovery-key", states("Your recovery key"), ("to Last two groups", "copy key")),
    Stop("04-typed-back", states("Your recovery key"), ("press Return",)),
    Stop("05-home", offers("New patient"), ("press ctrl+n",), lingers_s=1.0),
    Stop(
        "06-patient",
        at_step("PatientStep"),
        ("type DEMO-7", "to Birth year", "type 1990", "to Height", "type 178", "to Weight", "type 74"),
        lingers_s=1.0,
    ),
    Stop("07-patient-typed", offers("Attach sensors"), ("press Return",), lingers_s=1.0),
    Stop("07a-source", at_step("SensorsStep"), ("press Return",), lingers_s=1.0),
    Stop("07b-sensors", offers("Detect from movement"), PLACED_BY_KEYS, lingers_s=5.0),
    Stop("07c-placed", states("All six sensors are assigned and connected"), ("press Return",), lingers_s=1.0),
    Stop("08a-stand-still", at_step("StandStillStep"), ("press space",), lingers_s=1.0),
    Stop("08b-standing", is_recording, lingers_s=1.5),
    # its pictures in both themes are taken before the page turns by itself, which it does after some 8 s
    Stop("09-free-motion", lambda seen: at_step("FreeMotionStep")(seen) and seen.is_recording, lingers_s=4.0),
    *walk(1, ("press 1", "press space"), "press space"),
    Stop("10d-keep", offers("Include 1"), ("press i",), lingers_s=1.0),
    *walk(2, ("press 2", "press space"), "press space"),
    *walk(3, ("press 4", "press space"), "press space"),  # kept, and the next begun, by one key
    Stop("12d-keep", offers("Include 1"), ("press i",), lingers_s=1.0),
    Stop("12e-kept", offers("Results"), ("press Return",), lingers_s=1.0),
    Stop("13a-results", offers("Legs", "Data"), ("press f",), lingers_s=2.0, patience_s=60.0),
    Stop("13c-figures", states("Peaks and ranges"), ("press f", "press q"), lingers_s=1.0),
    Stop("13d-quality", offers("Engineering details"), ("press Escape", "to Summary", "press Right"), lingers_s=1.0),
    Stop("13e-compare", offers("Differences"), ("press Right",), lingers_s=1.0),
    Stop("13f-whole-walk", offers("Published"), ("press Right",), lingers_s=2.0),
    Stop("13g-strides", states("Excluded strides stay in the files with the reason"), ("press ctrl+7",), lingers_s=1.0),
    Stop("14a-report", at_step("ReportStep"), ("press ctrl+s",), lingers_s=1.0),
    Stop("14b-where", offers("Save"), ("press ctrl+a", "type {home}/report.pdf", "press Return"), lingers_s=1.0),
    Stop("14c-saved", states("Saved as"), ("press F1",), lingers_s=1.0),
    Stop("15-manual", offers("Search the help"), ("press Escape",), lingers_s=1.0),
    Stop("16-leave", at_step("ReportStep"), ("to Step 7", "press Down", "press Return")),
    Stop("17-home-again", offers("New session"), lingers_s=1.0),
)
MOUSE: tuple[Stop, ...] = (
    Stop("01-first-start", at("FirstStartPage"), ("click View the demonstration",)),
    Stop("05-home", offers("New session"), ("click New session",), lingers_s=1.0),
    Stop("06-patient", offers("Attach sensors"), ("click Attach sensors",), lingers_s=1.0),
    Stop("07a-source", at_step("SensorsStep"), ("click Simulated patient",), lingers_s=1.0),
    Stop("07b-sensors", offers("Detect from movement"), PLACED_BY_MOUSE, lingers_s=5.0),
    Stop("07c-placed", states("All six sensors are assigned and connected"), ("click Stand still",), lingers_s=1.0),
    Stop("08a-stand-still", at_step("StandStillStep"), ("click Start countdown",), lingers_s=1.0),
    Stop("08b-standing", is_recording, lingers_s=1.5),
    Stop("09-free-motion", lambda seen: at_step("FreeMotionStep")(seen) and seen.is_recording, lingers_s=7.0),
    *walk(1, ("click Barefoot", "click Start walk"), "click Stop walk"),
    Stop("10d-keep", offers("Include 1"), ("click Include 1",), lingers_s=1.0),
    *walk(2, ("click Shoes", "click Start walk"), "click Stop walk"),
    *walk(3, ("click Alignment A", "click Include, start next"), "click Stop walk"),
    Stop("12d-keep", offers("Include 1"), ("click Include 1",), lingers_s=1.0),
    Stop("12e-kept", offers("Results"), ("click Results",), lingers_s=1.0),
    Stop("13a-results", offers("Legs", "Data"), ("click All values",), lingers_s=2.0, patience_s=60.0),
    Stop("13c-figures", states("Peaks and ranges"), ("click All values", "click Data"), lingers_s=1.0),
    Stop("13d-quality", offers("Engineering details"), ("click Summary", "click Compare"), lingers_s=1.0),
    Stop("13e-compare", offers("Differences"), ("click Whole walk",), lingers_s=1.0),
    Stop("13f-whole-walk", offers("Published"), ("click Strides",), lingers_s=2.0),
    Stop(
        "13g-strides",
        states("Excluded strides stay in the files with the reason"),
        ("click Write report",),
        lingers_s=1.0,
    ),
    Stop("14a-report", at_step("ReportStep"), ("click Save report",), lingers_s=1.0),
    Stop("14b-where", offers("Save"), ("click Save",), lingers_s=1.0),
    Stop("14c-saved", states("Saved as"), ("click Help",), lingers_s=1.0),
    Stop("15-manual", offers("Search the help"), ("click Back",), lingers_s=1.0),
    Stop("16-leave", at_step("ReportStep"), ("click All patients",)),
    Stop("17-home-again", offers("New session"), lingers_s=1.0),
)
SECOND_BY_KEYS: tuple[Stop, ...] = (  # the same patient comes back: nothing is typed, one condition is walked
    Stop("21-second-visit", offers("New session"), ("press Return",), lingers_s=1.0),
    Stop("22-patient", offers("Use last visit's set-up"), ("press Return",), lingers_s=1.0),
    Stop("23-stand-still", at_step("StandStillStep"), ("press space",)),
    Stop("24a-standing", lambda seen: at_step("StandStillStep")(seen) and seen.is_recording),
    Stop("24b-free-motion", lambda seen: at_step("FreeMotionStep")(seen) and seen.is_recording, lingers_s=7.0),
    *walk(15, ("press 1", "press space"), "press space"),
    Stop("24d-keep", offers("Include 1"), ("press i",), lingers_s=1.0),
    Stop("24e-kept", offers("Results"), ("press Return",), lingers_s=1.0),
    Stop("25a-results", offers("Legs", "Data"), ("press ctrl+7",), lingers_s=2.0, patience_s=60.0),
    Stop("26a-report", shows_pages, ("press ctrl+s",), lingers_s=2.0, patience_s=60.0),
    Stop("26b-where", offers("Save"), ("press ctrl+a", "type {home}/second.pdf", "press Return"), lingers_s=1.0),
    Stop("26c-saved", states("Saved as"), ("to Step 7", "press Down", "press Return"), lingers_s=1.0),
    Stop("27-home-again", offers("New session"), lingers_s=2.0),
)
BRISK_S = 0.5  # nobody looks round where keys are counted; a page that turned by itself takes none before


def counted(stops: Sequence[Stop]) -> tuple[Stop, ...]:
    """The same stops without lingering, and with their keys counted."""
    return tuple(replace(stop, lingers_s=BRISK_S, is_counted=True) for stop in stops)


# a new patient with two walks, and one who comes back: with the fewest keys, each counted
NEW: tuple[Stop, ...] = (
    *(stop for stop in KEYBOARD if stop.name < "05"),
    *counted(
        (
            Stop("05-home", offers("New patient"), ("press ctrl+n",)),
            Stop("06-patient", at_step("PatientStep"), ("type DEMO-7",)),
            Stop("07-patient-typed", offers("Attach sensors"), ("press Return",)),
            Stop("07a-source", at_step("SensorsStep"), ("press Return",)),
            Stop("07b-sensors", offers("Detect from movement"), PLACED_BY_KEYS),
            Stop("07c-placed", states("All six sensors are assigned and connected"), ("press Return",)),
            Stop("08a-stand-still", at_step("StandStillStep"), ("press space",)),
            Stop("09-free-motion", lambda seen: at_step("FreeMotionStep")(seen) and seen.is_recording, patience_s=60.0),
            *walk(1, ("press space",), "press space"),
            *walk(2, ("press space",), "press space"),  # the first is kept, and the second begun, by one key
            Stop("12d-keep", offers("Include 1"), ("press i",)),
            Stop("12e-kept", offers("Results"), ("press Return",)),
            Stop("13a-results", offers("Write report"), ("press Return",), patience_s=60.0),
            Stop("14a-report", shows_pages, ("press Return",), patience_s=60.0),
            Stop("14b-where", offers("Save"), ("press Return",)),
            Stop("14c-saved", states("Saved as")),
        )
    ),
)
RETURNING: tuple[Stop, ...] = (
    *(replace(stop, is_counted=False) for stop in NEW),
    Stop("16-leave", at_step("ReportStep"), ("to Step 7", "press Down", "press Return")),
    *counted(
        (
            Stop("21-second-visit", offers("New session"), ("press Return",)),
            Stop("22-patient", offers("Use last visit's set-up"), ("press Return",)),
            Stop("23-stand-still", at_step("StandStillStep"), ("press space",)),
            Stop("24a-standing", lambda seen: at_step("StandStillStep")(seen) and seen.is_recording),
            Stop("24b-free-motion", lambda seen: at_step("FreeMotionStep")(seen) and seen.is_recording),
            *walk(15, ("press space",), "press space"),
            Stop("24d-keep", offers("Include 1"), ("press i",)),
            Stop("24e-kept", offers("Results"), ("press Return",)),
            Stop("25a-results", offers("Write report"), ("press Return",), patience_s=60.0),
            Stop("26a-report", shows_pages, ("press Return",), patience_s=60.0),
            Stop("26b-where", offers("Save"), ("press Return",)),
            Stop("26c-saved", states("Saved as")),
        )
    ),
)
SECOND_BY_MOUSE: tuple[Stop, ...] = (
    Stop("21-second-visit", offers("New session"), ("click New session",), lingers_s=1.0),
    Stop("22-patient", offers("Use last visit's set-up"), ("click Use last visit's set-up",), lingers_s=1.0),
    Stop("23-stand-still", at_step("StandStillStep"), ("click Start countdown",)),
    Stop("24a-standing", lambda seen: at_step("StandStillStep")(seen) and seen.is_recording),
    Stop("24b-free-motion", lambda seen: at_step("FreeMotionStep")(seen) and seen.is_recording, lingers_s=7.0),
    *walk(15, ("click Shoes", "click Start walk"), "click Stop walk"),
    Stop("24d-keep", offers("Include 1"), ("click Include 1",), lingers_s=1.0),
    Stop("24e-kept", offers("Results"), ("click Results",), lingers_s=1.0),
    Stop("25a-results", offers("Legs", "Data"), ("click Compare",), lingers_s=2.0, patience_s=60.0),
    Stop("25b-compare", offers("Differences"), ("click Write report",), lingers_s=1.0),
    Stop("26a-report", at_step("ReportStep"), ("click Save report",), lingers_s=2.0),
    Stop("26b-where", offers("Save"), ("click Save",), lingers_s=1.0),
    Stop("26c-saved", states("Saved as"), ("click All patients",), lingers_s=1.0),
    Stop("27-home-again", offers("New session"), lingers_s=2.0),
)
BENCH_UP_TO = next(k for k, stop in enumerate(KEYBOARD) if stop.name == "10a-choose")
PROSTHETIC = ("to Neither", "press Right", "to Affected", "press Right")


def pressed(key: str, times: int) -> tuple[str, ...]:
    return (f"press {key}",) * times


def part_chosen(number: int) -> tuple[str, ...]:
    """By the key that the card shows, and by its place in the list: every language has another first letter."""
    return ("press c", "press Home", *pressed("Down", number))


FRONT_SCREW, KNEE_UNIT, KNEE_PROGRAM, PYLON = 0, 10, 11, 12


BENCH: tuple[Stop, ...] = (  # three alignments of one prosthesis and the first again, by keys that the screen shows
    *(
        replace(stop, does=(*stop.does, *PROSTHETIC)) if stop.name == "06-patient" else stop
        for stop in KEYBOARD[:BENCH_UP_TO]
    ),
    *walk(1, ("press space",), "press space"),
    Stop("31-a-walked", offers("Include A"), ("press Return",), lingers_s=1.0, patience_s=60.0),
    Stop(
        "32-a-kept",
        offers("Repeat A"),
        (
            *(*part_chosen(PYLON), "to Height", *pressed("plus", 3), *part_chosen(FRONT_SCREW)),
            *("to Angle", *pressed("plus", 4), "to Screw turns", *pressed("Up", 4), "to Shift", *pressed("plus", 4)),
            *(*part_chosen(KNEE_UNIT), "to Screw turns", *pressed("plus", 12)),
            *(*part_chosen(KNEE_PROGRAM), "press Tab", "type Walk 1", "press Tab", "type Walk 2", "press Return"),
        ),
    ),
    Stop("33-b-told", offers("Walk with B"), ("press space",), lingers_s=1.0),
    Stop("33a-b-walking", has_walked(STRIDES), ("press space",), patience_s=60.0),
    Stop("34-b-against-a", compares("B"), ("press Return",), lingers_s=3.0, patience_s=60.0),
    Stop(
        "35-b-kept",
        offers("Repeat B"),
        (*part_chosen(KNEE_UNIT), "to Angle", *pressed("plus", 8), "press space"),
        lingers_s=1.0,
    ),
    Stop("35a-c-walking", has_walked(STRIDES), ("press space",), patience_s=60.0),
    Stop("36-c-against-b", compares("C"), ("press Return", "press 3", "press shift+1"), lingers_s=3.0, patience_s=60.0),
    Stop("37-c-against-a", states("C \N{MINUS SIGN} A"), ("press r",), lingers_s=1.0),
    Stop("38-back-to-a", states("Undo first"), ("press space",), lingers_s=1.0),
    Stop("38a-a-walking", has_walked(STRIDES), ("press space",), patience_s=60.0),
    Stop("39-a2-against-a", compares("A2"), ("press Return", "press 2"), lingers_s=3.0, patience_s=60.0),
    Stop(
        "39a-b-with-variation", states("variation of A. Its two walks"), ("to Results", "press Return"), lingers_s=1.0
    ),
    Stop("40-results", offers("Legs", "Data"), ("press ctrl+7",), lingers_s=1.0, patience_s=60.0),
    Stop("41-report", at_step("ReportStep"), ("to Export data", "press space"), lingers_s=1.0, patience_s=60.0),
    Stop("42-where", offers("Save"), ("press ctrl+a", "type {home}/results", "press Return"), lingers_s=1.0),
    Stop(
        "43-saved",
        states("Saved as results"),
        lingers_s=2.0,
        leaves=(
            ("results*/**/alignments.csv", " A,foot_front_screw,2,0.5,4,"),
            ("results*/**/alignments.csv", " A,knee_unit,,1.5,,"),
            ("results*/**/alignments.csv", ",Walk 1,Walk 2,,,,"),
            ("results*/**/alignments.csv", " B,knee_unit,4,,,"),
            ("results*/**/alignments.csv", ",Walk 2,Walk 1,,,,"),
            ("results*/**/summary.json", "returns_to"),
            ("results*/**/summary.json", "foot_front_screw"),
            ("results*/**/differences.csv", "foot_heel_rise_deg"),
        ),
    ),
)
CLOCK_RUNS = states("Clock runs")


def is_over(words: str) -> Callable[[Seen], bool]:
    """Whether a test was recorded and analysed, and its result is shown."""
    return lambda seen: not seen.is_recording and seen.states(words) and not seen.states("being analysed")


def timed_test(number: int, chosen: tuple[str, ...], name: str, ends: tuple[str, ...] = ()) -> tuple[Stop, ...]:
    """Give the stops of one timed test: chosen, running, over; `ends` are keys that end it early."""
    return (
        Stop(f"{number}a-choose", lambda seen: not seen.is_recording, chosen, patience_s=90.0),
        Stop(f"{number}b-chosen", states(f"Next: {name}"), ("press space",), lingers_s=1.0),
        Stop(f"{number}c-running", CLOCK_RUNS, ends, lingers_s=12.0 if ends else 3.0, patience_s=60.0),
        Stop(f"{number}d-over", is_over(f"{name}: "), ("press i",), lingers_s=1.0, patience_s=90.0),
        Stop(f"{number}e-included", offers("Results"), lingers_s=1.0),
    )


SIT_TO_STAND = "5 \N{MULTIPLICATION SIGN} sit to stand"
LENGTH = "to Chair to cone", "press ctrl+a"
TIMED: tuple[Stop, ...] = (  # every timed test, by keys; those of minutes are ended by a key after 12 s
    *KEYBOARD[:BENCH_UP_TO],
    Stop("50-none", offers("Barefoot"), lingers_s=1.0, patience_s=90.0),
    *timed_test(51, ("press t",), "10-metre walk"),
    *timed_test(52, (*pressed("t", 3), "press c", "type 3", "press Return"), "Timed Up and Go"),
    # the course is said to be of 6 m: then it was not this test, until the length is put right
    Stop("52f-length", offers("Results"), (*LENGTH, "type 6", "press Return")),
    Stop("52g-not-valid", states("Not valid: "), (*LENGTH, "type 3", "press Return"), lingers_s=1.0),
    *timed_test(54, ("press t",), SIT_TO_STAND),
    *timed_test(55, ("press t",), "Stairs"),
    *timed_test(56, pressed("t", 3), "2-minute walk", ("press space",)),
    *timed_test(57, ("press t", "press c", "type 15", "press Return"), "6-minute walk", ("press space",)),
    Stop("58-again", offers("Results"), ("press space",), lingers_s=1.0),
    Stop("58a-walking", is_recording, ("press Escape",), lingers_s=3.0, patience_s=60.0),
    Stop("58b-cancelled", lambda seen: not seen.is_recording, ("press x",), lingers_s=2.0, patience_s=60.0),
    Stop("58c-excluded", offers("Results"), ("press Escape",), lingers_s=1.0),
    Stop("58d-no-test", states("No timed test"), ("to Results", "press Return"), lingers_s=1.0),
    Stop("59-results", offers("Legs", "Data"), ("press ctrl+7",), lingers_s=1.0, patience_s=90.0),
    Stop("60-report", shows_pages, ("press ctrl+s",), lingers_s=1.0, patience_s=90.0),
    Stop("60a-where", offers("Save"), ("press ctrl+a", "type {home}/report.pdf", "press Return"), lingers_s=1.0),
    Stop("60b-saved", states("Saved as"), ("to Export data", "press space"), lingers_s=1.0, patience_s=90.0),
    Stop("61-where", offers("Save"), ("press ctrl+a", "type {home}/results", "press Return"), lingers_s=1.0),
    Stop(
        "62-saved",
        states("Saved as results"),
        lingers_s=2.0,
        leaves=tuple(
            ("results*/**/timed_test.csv", f",{test},test,")
            for test in ("10 m", "up and go", "sit to stand 5", "stairs", "2 min", "6 min")
        ),
    ),
)
REVIEWED: tuple[Stop, ...] = (  # the demonstration up to its results, which Rerun shows then, and its report
    *(stop for stop in MOUSE if stop.name < "13a"),
    Stop("51-results", offers("Legs", "Review in Rerun"), ("click Review in Rerun", "await Rerun"), patience_s=90.0),
    Stop("52-rerun", offers("Legs", "Review in Rerun"), ("raise Gaitwright",), lingers_s=20.0),
    Stop("53-report", offers("Write report"), ("click Write report",), lingers_s=1.0),
    *(stop for stop in MOUSE if stop.name.startswith("14")),
)
SOURCE = next(k for k, stop in enumerate(KEYBOARD) if stop.name == "07a-source")
PELVIS: tuple[Stop, ...] = (  # seven sensors, by keys
    *KEYBOARD[:SOURCE],
    Stop("51-source", at_step("SensorsStep"), ("to Simulated patient, seven", "press Return"), lingers_s=1.0),
    Stop("52-sensors", offers("Detect from movement"), (*PLACED_BY_KEYS, "press 7"), lingers_s=5.0),
    Stop("53-placed", states("All seven sensors are assigned and connected"), ("press Return",), lingers_s=1.0),
    Stop("54-stand-still", at_step("StandStillStep"), ("press space",), lingers_s=1.0),
    Stop("55-standing", is_recording, lingers_s=1.5),
    Stop("56-lunges", lambda seen: at_step("FreeMotionStep")(seen) and seen.is_recording, lingers_s=5.0),
    Stop("57-free-motion", at_step("FreeMotionStep"), lingers_s=6.0),
    *(replace(stop, name=f"58{stop.name[2:]}") for stop in walk(1, ("press 1", "press space"), "press space")),
    Stop("59-keep", offers("Include 1"), ("press i",), lingers_s=1.0),
    Stop("60-kept", offers("Results"), ("press Return",), lingers_s=1.0),
    Stop("61-results", offers("Legs", "Data"), ("press ctrl+7",), lingers_s=2.0, patience_s=60.0),
    Stop("62-report", at_step("ReportStep"), ("to Export data", "press space"), lingers_s=2.0),
    Stop("63-where", offers("Save"), ("press ctrl+a", "type {home}/results", "press Return"), lingers_s=1.0),
    Stop("64-saved", states("Saved as"), lingers_s=2.0, leaves=(("results*/**/angles.csv", "left_hip_deg"),)),
)
# a target and a metronome by keys, a walk towards it, and the patient's screen in a corner, full and closed
PATIENT: tuple[Stop, ...] = (
    *KEYBOARD[:BENCH_UP_TO],
    Stop("51-choose", offers("Patient screen"), ("press F8",), lingers_s=1.0, patience_s=90.0),
    Stop(
        "52-opened", states("No target yet"), ("press Right", "press Left", "press Tab", "press Right", "press Return")
    ),
    Stop("53-out-of-range", focus_on("Target"), ("type 555", "press Return"), lingers_s=1.0),
    Stop("54-refused", states("Enter a whole number"), ("press ctrl+a", "type 40", "press Return"), lingers_s=1.0),
    Stop("55-target", states("Target 40"), ("to Metronome", "type 100", "press Return")),
    Stop("56-ticks", offers("Stop metronome"), lingers_s=1.0),
    Stop("57-stands", states("Target 40"), ("press space",), lingers_s=1.0),
    Stop("58-bar", lambda seen: seen.is_recording and seen.states("Now ")),
    Stop("59-walks", states("Last "), ("press F11",)),
    Stop("60-full", offers("Small window"), ("press F11",), lingers_s=1.0),
    Stop("61-corner", offers("Full screen")),
    Stop("61a-standing", states("The patient is standing"), ("press space",)),
    Stop("62-walked", lambda seen: not seen.is_recording, ("press Escape",), lingers_s=4.0, patience_s=60.0),
    Stop("63-closed", lambda seen: not seen.states("Target 40"), ("press F8",), lingers_s=1.0),
    Stop("64-again", states("Target 40"), ("press F8",), lingers_s=1.0),
    Stop("65-closed", lambda seen: not seen.states("Target 40"), ("press i",), lingers_s=1.0),
    Stop("66-kept", offers("Results"), lingers_s=1.0),
)
SWAPPED = {"L shank": "R thigh", "R thigh": "L shank"}  # where somebody straps them by mistake
SWAPPED_BY_KEYS = tuple(
    key for place in PLACES.values() for key in (f"press {DIGITS[SWAPPED.get(place, place)]}", "press Down")
)
DEAD_ENDS: tuple[Stop, ...] = (  # what once led nowhere: swapped sensors, a key with the focus elsewhere, by keys
    *KEYBOARD[: SOURCE + 1],
    Stop("51-sensors", offers("Detect from movement"), SWAPPED_BY_KEYS, lingers_s=5.0),
    Stop("52-placed", states("All six sensors are assigned and connected"), ("press Return",), lingers_s=1.0),
    Stop("53-stand-still", at_step("StandStillStep"), ("press space",), lingers_s=1.0),
    Stop("54-standing", is_recording, lingers_s=1.5),
    Stop("55-swapped", offers("Use detected positions"), ("press Return",), lingers_s=1.0, patience_s=90.0),
    Stop("56-put-right", at_step("FreeMotionStep"), lingers_s=3.0),
    # the focus is on another button: the key that the bar shows belongs to the bar
    *(
        replace(stop, name=f"57{stop.name[2:]}")
        for stop in walk(1, ("press 1", "to Back", "press space"), "press space")
    ),
    Stop("58-keep", offers("Include 1"), ("press i",), lingers_s=1.0),
    Stop("59-kept", offers("Results"), ("press Return",), lingers_s=1.0),
    Stop("60-results", offers("Legs", "Data"), ("press ctrl+7",), lingers_s=2.0, patience_s=60.0),
    Stop("61-report", at_step("ReportStep"), ("to Export data", "press space"), lingers_s=2.0),
    Stop("62-where", offers("Save"), ("press ctrl+a", "type {home}/results", "press Return"), lingers_s=1.0),
    Stop(
        "63-saved",
        states("Saved as"),
        ("to Step 7", "press Down", "press Return"),
        lingers_s=2.0,
        leaves=(("results*/**/angles.csv", "left_knee_deg"),),
    ),
    *(stop for stop in SECOND_BY_KEYS if stop.name < "26a"),
    Stop("71-report", shows_pages, ("to Compare with", "press Down"), lingers_s=2.0, patience_s=60.0),
    Stop("72-compared", shows_pages, ("to Export data", "press space"), lingers_s=6.0, patience_s=60.0),
    Stop("73-where", offers("Save"), ("press ctrl+a", "type {home}/second", "press Return"), lingers_s=1.0),
    Stop("74-saved", states("Saved as"), lingers_s=2.0, leaves=(("second*/**/angles.csv", "left_knee_deg"),)),
)
TOURS = {
    "keyboard": (*KEYBOARD, *SECOND_BY_KEYS),
    "mouse": (*MOUSE, *SECOND_BY_MOUSE),
    "new": NEW,
    "returning": RETURNING,
    "bench": BENCH,
    "timed": TIMED,
    "review": REVIEWED,
    "pelvis": PELVIS,
    "patient": PATIENT,
    "dead-ends": DEAD_ENDS,
}

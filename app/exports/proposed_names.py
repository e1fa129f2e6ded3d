"""Names proposed for what is saved outside the library: the patient's code and the day of the session, never a name."""

from pathlib import Path

LONGEST_CODE = 60  # characters of it in a name
# Windows keeps these for devices, whatever ending follows
DEVICES = {"con", "prn", "aux", "nul", *(f"{port}{number}" for port in ("com", "lpt") for number in range(10))}


def session_name(code: str, started: str, what: str = "") -> str:
    """The patient's code, the day and, where it is not the report, what it is, in letters that any system takes."""
    safe = "".join(letter if letter.isalnum() or letter == "-" else "_" for letter in code)[:LONGEST_CODE]
    name = "_".join(filter(None, [safe or "session", started[:10], what]))
    return f"session_{name}" if name.lower() in DEVICES else name


def free_name(place: Path, name: str, suffix: str = "") -> str:
    """A name that is not taken in a folder: a second session of a day is put beside the first."""
    name, names = f"{name}{suffix}", (f"{name}{suffix}", *(f"{name}_{number}{suffix}" for number in range(2, 1000)))
    return next((one for one in names if not (place / one).exists()), name)

"""`session.toml`, read to a session and written from one.

Every key that means something is in one of the tables below, once, with the check that its value must pass. What
is in none of them is unknown: it is kept where it was, with a finding.
"""

import datetime
import math
import re
import tomllib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import PurePosixPath
from typing import Any

import tomli_w

from core.alignment import alignment_of_table, alignment_table
from core.body import LEG_JOINTS, Joint, Side, Site
from core.findings import Finding, Severity
from core.goals import goal_table, goals_of_tables
from core.prosthesis import prostheses_of_tables, prostheses_tables
from core.samples import RateKind, SensorInfo
from core.session import Patient, Recording, RecordingKind, Session
from core.timed.protocols import TABLE_KEYS, planned_of_table, planned_table
from devices.files.refusal import FileRefusedError, quoted
from devices.files.stored_findings import finding_tables, findings_of_tables

FORMAT = "gaitwright-session/1"
FILE_NAME = "session.toml"
CORRECT_IT = f"Correct {FILE_NAME}"
STATES_FORMAT = f'The first line of session.toml must be format = "{FORMAT}"'
SIDES = ("left", "right", "both", "none", "")
PROSTHESES = "prosthesis"  # of the patient, a table for each side
DEEPEST = 50  # tables and lists within each other; ours need four

Check = Callable[[object], Any]
Known = tuple[str, Check]
Table = Mapping[str, object]


@dataclass(frozen=True, slots=True)
class Plan:
    """One `[[recordings]]` table: a recording whose samples are still to be read."""

    recording: Recording
    sensors: Mapping[Site, str]
    rates_derived: frozenset[Site]


class ExpectedError(ValueError):
    """A value is not what it has to be: `what` that is, with `values` for its braces."""

    def __init__(self, what: str, **values: object) -> None:
        self.what, self.values = what, values
        super().__init__(what.format(**values))


def _text(value: object) -> str:
    if isinstance(value, datetime.datetime | datetime.date | datetime.time):
        return value.isoformat()
    if not isinstance(value, str):
        raise ExpectedError("a text in quotation marks")
    return value


def _truth(value: object) -> bool:
    if not isinstance(value, bool):
        raise ExpectedError("true or false")
    return value


def _number(lowest: float, highest: float, unit: str) -> Check:
    def check(value: object) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float) or not lowest <= value <= highest:
            raise ExpectedError(
                "a number from {lowest:g} to {highest:g} {unit}", lowest=lowest, highest=highest, unit=unit
            )
        return float(value)

    return check


def _year(value: object) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not 1850 <= value <= 2200:
        raise ExpectedError("a year such as 1950")
    return value


def _sign(value: object) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or value not in (1, -1):
        raise ExpectedError("1 or -1")
    return value


def _one_of(words: Iterable[str], make: Callable[[str], Any] = str) -> Check:
    allowed = tuple(words)

    def check(value: object) -> Any:
        if not isinstance(value, str) or value not in allowed:
            raise ExpectedError("one of {words}", words=", ".join(word for word in allowed if word))
        return make(value)

    return check


def _filled(value: object) -> str:
    if not isinstance(value, str) or not value.strip():
        raise ExpectedError("a text that is not empty")
    return value


def _inside(value: object) -> str:
    """A folder below the session folder, and not that folder itself."""
    parts = re.split(r"[/\\]", value) if isinstance(value, str) else [""]
    is_absolute = not parts[0] or ":" in parts[0]
    if not isinstance(value, str) or is_absolute or ".." in parts or "\0" in value or not PurePosixPath(value).name:
        raise ExpectedError("the name of a folder inside of the session folder")
    return value


def _site_texts(value: object) -> dict[Site, str]:
    """Which sensor was where, in one recording; empty when the key holds something else, which is then unknown."""
    is_ours = isinstance(value, dict) and all(k in list(Site) and isinstance(v, str) for k, v in value.items())
    return {Site(site): text for site, text in value.items()} if isinstance(value, dict) and is_ours else {}


def _site_list(value: object) -> frozenset[Site]:
    """Where rates were derived; empty when the key holds something else, which is then unknown."""
    is_ours = isinstance(value, list) and all(site in list(Site) for site in value)
    return frozenset(Site(site) for site in value) if isinstance(value, list) and is_ours else frozenset()


def _left_out(value: object) -> dict[Side, tuple[float, ...]]:
    """Which strides were left out by hand; empty when the key holds something else, which is then unknown."""
    if not isinstance(value, dict) or not set(value) <= set(Side):
        return {}
    if not all(isinstance(times, list) and all(_is_time(one) for one in times) for times in value.values()):
        return {}
    return {Side(side): tuple(sorted(float(one) for one in times)) for side, times in value.items() if times}


def _is_time(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


# Key in the file -> name of the attribute and check. The order is the order of writing.
SESSION: Mapping[str, Known] = {
    "started": ("started", _text),
    "operator": ("operator", _text),
    "surface": ("surface", _text),
    "notes": ("notes", _text),
    "software": ("software", _text),
    "simulated": ("is_simulated", _truth),
}
PATIENT: Mapping[str, Known] = {
    "code": ("code", _text),
    "birth_year": ("birth_year", _year),
    "sex": ("sex", _text),
    "height_m": ("height_m", _number(0.3, 2.8, "m")),
    "mass_kg": ("mass_kg", _number(1.0, 500.0, "kg")),
    "device": ("device", _text),
    "aids": ("aids", _text),
    "affected_side": ("affected_side", _one_of(SIDES)),
    "prosthetic_side": ("prosthetic_side", _one_of(SIDES)),
}
SENSOR: Mapping[str, Known] = {
    "serial": ("serial", _text),
    "model": ("model", _text),
    "firmware": ("firmware", _text),
    "rate_hz": ("rate_hz", _number(0.001, 100_000.0, "Hz")),
    "rate_kind": ("rate_kind", _one_of(RateKind, RateKind)),
    "clock": ("clock", _text),
}
RECORDING: Mapping[str, Known] = {
    "name": ("name", _filled),
    "kind": ("kind", _one_of(RecordingKind, RecordingKind)),
    "folder": ("folder", _inside),
    "condition": ("condition", _text),
    "started": ("started", _text),
    "kept": ("is_kept", _truth),
    "note": ("note", _text),
    "restrapped_before": ("is_restrapped_before", _truth),
}
REQUIRED = ("name", "kind", "folder")
TABLES = ("session", "patient", "sensors", "zero", "sign")
ZERO: Mapping[str, Known] = {joint.value: (joint.value, _number(-180.0, 180.0, "°")) for joint in LEG_JOINTS}
SIGN: Mapping[str, Known] = {joint.value: (joint.value, _sign) for joint in LEG_JOINTS}


def parse(text: str) -> tuple[Session, tuple[Plan, ...]]:
    """Give the session without recordings, and the recordings to read; raises FileRefusedError."""
    return parse_document(parse_toml(text))


def parse_toml(text: str) -> dict[str, object]:
    """Give the file's tables; raises FileRefusedError for no TOML or endless nesting."""
    try:
        document: dict[str, object] = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise FileRefusedError(FILE_NAME, "the file is not TOML ({why})", CORRECT_IT, why=error) from error
    if _is_deeper(document, DEEPEST):
        raise FileRefusedError(FILE_NAME, "the tables in the file are nested too deeply", CORRECT_IT)
    return document


def parse_document(document: Table) -> tuple[Session, tuple[Plan, ...]]:
    """Give the session and the recordings to read; raises FileRefusedError for values missing or out of range."""
    _check_format(document)
    tables = {name: _table(document, name, f"[{name}]") for name in TABLES}
    session_values, session_unknown = _take(tables["session"], SESSION, "[session]")
    patient_values, patient_unknown = _take(tables["patient"], PATIENT, "[patient]")
    zero_deg, zero_unknown = _take(tables["zero"], ZERO, "[zero]")
    goals = goals_of_tables(patient_unknown.get("goals"))
    prostheses, not_understood = prostheses_of_tables(patient_unknown.pop(PROSTHESES, {}))
    patient_unknown = {key: value for key, value in patient_unknown.items() if not (key == "goals" and goals)}
    patient_unknown |= {PROSTHESES: not_understood} if not_understood is not None else {}
    signs, sign_unknown = _take(tables["sign"], SIGN, "[sign]")
    sensors = {site: _sensor(tables["sensors"], site) for site in Site if site in tables["sensors"]}
    nested = {
        "session": session_unknown,
        "sensors": {key: value for key, value in tables["sensors"].items() if key not in sensors},
        "zero": zero_unknown,
        "sign": sign_unknown,
    }
    findings = findings_of_tables(document.get("findings"))
    known = ("format", "recordings", *TABLES, *(["findings"] if findings is not None else []))
    top = {key: value for key, value in document.items() if key not in known}
    session = Session(
        recordings=(),
        patient=Patient(**patient_values, goals=goals or (), prostheses=prostheses, unknown=patient_unknown),
        sensors=sensors,
        zero_rad={Joint(key): math.radians(value) for key, value in zero_deg.items()},
        turned_sign={Joint(key): value for key, value in signs.items()},
        findings=findings or (),
        unknown=top | {key: value for key, value in nested.items() if value},
        **session_values,
    )
    return session, _plans(document.get("recordings", []))


def render(session: Session, plans: Sequence[Plan]) -> str:
    """Write the text `parse` reads back, keys in format order, unknown ones last; raises FileRefusedError."""
    nested = {key: _unknown_table(session, key) for key in TABLES}
    zero_deg = {joint.value: round(math.degrees(value), 9) for joint, value in session.zero_rad.items()}
    sensors = {site.value: _render(info, SENSOR) | dict(info.unknown) for site, info in session.sensors.items()}
    document: dict[str, object] = {
        "format": FORMAT,
        "session": _render(session, SESSION) | nested["session"],
        "patient": _render_patient(session.patient),
        "sensors": sensors | nested["sensors"],
        "zero": zero_deg | nested["zero"],
        "sign": {joint.value: sign for joint, sign in session.turned_sign.items()} | nested["sign"],
    }
    document = {key: value for key, value in document.items() if value != {}}
    document |= {key: value for key, value in session.unknown.items() if key not in document and key not in TABLES}
    document["recordings"] = [_render_plan(plan) for plan in plans]
    if found := finding_tables(session.findings):
        document["findings"] = found
    text = tomli_w.dumps(document)
    parse(text)
    return text


def unknown_keys(session: Session) -> tuple[Finding, ...]:
    """A finding for every key that means nothing to us. One under `zero` or `sign` was meant to turn a result."""
    places: list[tuple[str, Table]] = [
        (FILE_NAME, {key: value for key, value in session.unknown.items() if key not in TABLES}),
        *((name, _unknown_table(session, name)) for name in TABLES),
        ("patient", session.patient.unknown),
        *((site.value, info.unknown) for site, info in session.sensors.items()),
        *((recording.name, recording.unknown) for recording in session.recordings),
    ]
    return tuple(
        Finding("unknown_key", Severity.WARNING if place in ("zero", "sign") else Severity.INFO, place, {"name": key})
        for place, table in places
        for key in table
    )


def default_sensor(session: Session, site: Site) -> str:
    """What a sensor is called when its recording does not say."""
    return session.sensors.get(site, SensorInfo()).serial or site.value


def _is_deeper(value: object, most: int) -> bool:
    inner = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    return most == 0 or any(_is_deeper(one, most - 1) for one in inner)


def _check_format(document: Table) -> None:
    name = document.get("format")
    if name == FORMAT:
        return
    later = re.fullmatch(r"gaitwright-session/(\d{1,9})", name) if isinstance(name, str) else None
    if later and int(later[1]) > 1:
        raise FileRefusedError(
            FILE_NAME,
            "this session was written by a later version ({version})",
            "Update Gaitwright, then open the session again",
            version=quoted(name),
        )
    if name is None:
        raise FileRefusedError(FILE_NAME, "the format is missing", STATES_FORMAT)
    raise FileRefusedError(FILE_NAME, "the format {name} is unknown", STATES_FORMAT, name=quoted(name))


def _plans(tables: object) -> tuple[Plan, ...]:
    if not isinstance(tables, list) or not all(isinstance(table, dict) for table in tables):
        raise FileRefusedError(
            FILE_NAME, "recordings is not a list of tables", "Start each recording with [[recordings]]"
        )
    if not tables:
        raise FileRefusedError(
            FILE_NAME, "there is no recording", "Add a recording with [[recordings]] and its name, kind and folder"
        )
    plans: list[Plan] = []
    for number, table in enumerate(tables, 1):
        name = table.get("name")
        where = f"[[recordings]] {quoted(name) if isinstance(name, str) and name else f'number {number}'}"
        for key in REQUIRED:
            if key not in table:
                raise FileRefusedError(f"{FILE_NAME}, {where}", "{key} is missing", CORRECT_IT, key=key)
        values, unknown = _take(table, RECORDING, where)
        sensors = _site_texts(unknown.get("sensors"))
        rates_derived = _site_list(unknown.get("rates_derived"))
        left_out_s = _left_out(unknown.get("strides_left_out"))
        alignment, test = alignment_of_table(unknown.get("alignment")), planned_of_table(unknown)
        understood: dict[str, object] = {
            "sensors": sensors,
            "rates_derived": rates_derived,
            "strides_left_out": left_out_s,
            "alignment": alignment,
            **dict.fromkeys(TABLE_KEYS, test),
        }
        unknown = {key: value for key, value in unknown.items() if not understood.get(key)}
        recording = Recording(imu={}, left_out_s=left_out_s, alignment=alignment, test=test, unknown=unknown, **values)
        for other in (plan.recording for plan in plans):
            for key in ("name", "folder"):
                if _normal(getattr(other, key), key) == _normal(getattr(recording, key), key):
                    raise FileRefusedError(
                        f"{FILE_NAME}, {where}",
                        "two recordings have the same {key}: {value}",
                        "Give each recording its own {key}",
                        key=key,
                        value=quoted(getattr(recording, key)),
                    )
        plans.append(Plan(recording, sensors, rates_derived))
    return tuple(plans)


def _normal(text: str, key: str) -> str:
    return str(PurePosixPath(text)) if key == "folder" else text


def _sensor(sensors: Table, site: Site) -> SensorInfo:
    values, unknown = _take(_table(sensors, site.value, f"[sensors.{site}]"), SENSOR, f"[sensors.{site}]")
    return SensorInfo(**values, unknown=unknown)


def _table(document: Table, name: str, where: str) -> Table:
    table = document.get(name, {})
    if not isinstance(table, dict):
        raise FileRefusedError(f"{FILE_NAME}, {where}", "this part is not a table of keys and values", CORRECT_IT)
    return table


def _take(table: Table, known: Mapping[str, Known], where: str) -> tuple[dict[str, Any], dict[str, object]]:
    """Checked values by attribute, and all that is unknown."""
    values: dict[str, Any] = {}
    for key, value in table.items():
        if key not in known:
            continue
        attribute, check = known[key]
        try:
            values[attribute] = check(value)
        except ValueError as error:
            raise FileRefusedError(
                f"{FILE_NAME}, {where}",
                "{key} is {value}, expected {required}",
                CORRECT_IT,
                key=key,
                value=quoted(value),
                required=error,
            ) from error
    return values, {key: value for key, value in table.items() if key not in known}


def _render(thing: Session | Patient | SensorInfo | Recording, known: Mapping[str, Known]) -> dict[str, object]:
    """Keys and values of all that differs from its default."""
    defaults = {field.name: field.default for field in fields(thing)}
    values = {key: (getattr(thing, attribute), defaults[attribute]) for key, (attribute, _) in known.items()}
    return {key: _plain(value) for key, (value, default) in values.items() if value != default}


def _render_patient(patient: Patient) -> dict[str, object]:
    goals = {"goals": [goal_table(goal) for goal in patient.goals]} if patient.goals else {}
    prostheses = prostheses_tables(patient.prostheses, patient.unknown.get(PROSTHESES))
    worn = {PROSTHESES: prostheses} if prostheses else {}
    return _render(patient, PATIENT) | goals | worn | {k: v for k, v in patient.unknown.items() if k not in worn}


def _render_plan(plan: Plan) -> dict[str, object]:
    table = _render(plan.recording, RECORDING)
    if plan.sensors:
        table["sensors"] = {site.value: plan.sensors[site] for site in Site if site in plan.sensors}
    if plan.rates_derived:
        table["rates_derived"] = [site.value for site in Site if site in plan.rates_derived]
    left_out_s = plan.recording.left_out_s
    if any(left_out_s.values()):
        table["strides_left_out"] = {side.value: list(left_out_s[side]) for side in Side if left_out_s.get(side)}
    if plan.recording.alignment is not None:
        table["alignment"] = alignment_table(plan.recording.alignment)
    table |= planned_table(plan.recording.test)
    return table | dict(plan.recording.unknown)


def _plain(value: object) -> object:
    return str(value) if isinstance(value, str) else value


def _unknown_table(session: Session, name: str) -> dict[str, object]:
    table = session.unknown.get(name, {})
    return dict(table) if isinstance(table, Mapping) else {}

"""The names that OpenSense's mapping file gives to sensors: `myIMUMappings.xml` of Xsens and APDM readers."""

import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from devices.files.refusal import FileRefusedError, quoted
from devices.files.text_files import as_utf8
from devices.files.trial import ImportedTrial, plain_id

HEAD_BYTES = 4096
MOST_BYTES = 1_000_000
SENSOR, NAME_IN_MODEL = "ExperimentalSensor", "name_in_model"
CORRECT_IT = "Correct the mapping file, or give the positions with --map"


def is_mapping(path: Path) -> bool:
    """Whether a file is a mapping; raises OSError where it cannot be read."""
    if not path.is_file():
        return False
    with path.open("rb") as file:
        return b"DataReaderSettings>" in as_utf8(file.read(HEAD_BYTES))


def read_mapping(path: Path) -> Mapping[str, str]:
    """Read the names in the model by the sensors' ids; raises FileRefusedError for no XML or two names of one."""
    with path.open("rb") as file:
        content = file.read(MOST_BYTES)
    try:
        root = ET.fromstring(content)
    except (ET.ParseError, LookupError, ValueError) as error:  # the last two of encodings
        raise FileRefusedError(
            path.name, "the file is not a complete XML file ({why})", "Copy or export the file again", why=quoted(error)
        ) from error
    names: dict[str, str] = {}
    for sensor in root.iter(SENSOR):
        key, name = plain_id(sensor.get("name", "")), (sensor.findtext(NAME_IN_MODEL) or "").strip()
        if not key or not name:
            continue
        if names.get(key, name) != name or name in [other for one, other in names.items() if one != key]:
            raise FileRefusedError(path.name, "the file assigns {name} twice", CORRECT_IT, name=quoted(name))
        names[key] = name
    if not names:
        raise FileRefusedError(path.name, "the file names no sensors", CORRECT_IT)
    return names


def with_names(trial: ImportedTrial, names: Mapping[str, str]) -> ImportedTrial:
    """Call a trial's sensors as a mapping does; those that it does not name keep their names."""
    sensors, mapped = [], []
    for sensor in trial.sensors:
        known = [names[key] for key in map(plain_id, (*sensor.ids, sensor.info.serial, sensor.name)) if key in names]
        if known:
            mapped.append(known[0])
            sensor = replace(sensor, name=known[0], ids=tuple(dict.fromkeys((*sensor.ids, sensor.name))))
        sensors.append(sensor)
    return replace(trial, sensors=tuple(sensors), mapped=tuple(mapped))


def without_mappings(files: Sequence[Path]) -> tuple[list[Path], list[Path]]:
    """The recordings among files, and the mappings."""
    mappings = [path for path in files if is_mapping(path)]
    return [path for path in files if path not in mappings], mappings

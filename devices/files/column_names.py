"""What the name of a column states: the quantity, its axis, the unit where it is given, and of which sensor it is.

"acc_x_m_s2", "LeftShank Gyroscope X (deg/s)", "ax", "q0". What a name does not say is not guessed here.
"""

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

from devices.drivers.csv_serial import FORCE_UNITS, RATE_UNITS
from devices.files.refusal import FileRefusedError


class Quantity(StrEnum):
    """What a column holds."""

    TIME = "time"
    COUNTER = "counter"
    ACC = "acceleration"
    FREE_ACC = "free acceleration"
    GYR = "angular rate"
    MAG = "magnetic field"
    QUAT = "orientation"
    SAMPLE_RATE = "sample rate"


WORDS = {  # a word that names a quantity
    **dict.fromkeys(("acc", "accel", "acceleration", "accelerometer", "accelerations", "accelerometers"), Quantity.ACC),
    "freeacc": Quantity.FREE_ACC,
    **dict.fromkeys(("beschleunigungsmesser", "accéléromètre", "acelerómetro", "accelerometro"), Quantity.ACC),
    **dict.fromkeys(("gyr", "gyro", "gyros", "gyroscope", "gyroscopes", "omega", "angvel"), Quantity.GYR),
    **dict.fromkeys(("gyroskop", "giroscopio", "giroscópio", "gyroscoop", "drehrate"), Quantity.GYR),
    **dict.fromkeys(("mag", "magn", "magneto", "magnetometer", "magnetometers"), Quantity.MAG),
    **dict.fromkeys(("quat", "quaternion", "quaternions", "orientation"), Quantity.QUAT),
    **dict.fromkeys(("time", "timestamp", "timestamps", "times", "datetime"), Quantity.TIME),
    **dict.fromkeys(("uhrzeit", "zeit", "zeitstempel", "temps", "tiempo", "tempo", "tijd"), Quantity.TIME),
}
LETTERS = {"a": Quantity.ACC, "g": Quantity.GYR, "w": Quantity.GYR, "m": Quantity.MAG, "q": Quantity.QUAT}  # "ax", "q0"
PHRASES = (  # of several words, written as the one above
    (r"angular[\W_]*(?:velocity|rate|speed)|rotation[\W_]*rate|turn[\W_]*rate|rate[\W_]*of[\W_]*turn", " gyr "),
    (r"winkelgeschwindigkeit|vitesse[\W_]*angulaire|velocidad[\W_]*angular|velocit[aà][\W_]*angolare|角速度", " gyr "),
    (r"gyro[\W_]*rotation", " gyr "),
    (r"(?:free|linear|lin|user)[\W_]*acc(?:el(?:eration|erometer)?)?", " freeacc "),
    (r"lineare?[\W_]*beschleunigung|acc[eé]l[eé]ration[\W_]*lin[eé]aire|linear[\W_]*versnelling", " freeacc "),
    (r"accelerometer[\W_]*acceleration|specific[\W_]*force", " acc "),
    (r"\bbeschl\b|beschleunigung|acc[eé]l[eé]ration|aceleraci[oó]n|accelerazione|versnelling|加速度", " acc "),
    (r"\bas(?=[xyz]\b)", " gyr "),  # "AsX": angular speed, of WitMotion
    (r"\bgf(?=[xyz]\b)", " acc "),  # "gFx": of Physics Toolbox
    (r"magnetic[\W_]*field|magnetfeld|磁场", " mag "),
    (r"time[\W_]*stamp|时间", " timestamp "),
)
SHORT = re.compile(r"([agw])_([xyz])")  # in small letters, or with its unit: "A_x" may be of a sensor "A"
OTHER_WORDS = frozenset(
    str.split(
        "raw uncal uncalibrated norm magnitude mean std sd var bias offset temp temperature range scale delta inc "
        "jerk euler angle angles roll pitch yaw error status start stop end fine"
    )
)
EMPTY_WORDS = frozenset(
    str.split(
        "data date value values cal calib calibrated signal axis the in unix epoch epoc utc elapsed since reboot boot "
        "logging"
    )
)
NOT_FELT = frozenset(str.split("gravity gravitation grav schwerkraft"))  # its direction alone, in units of acceleration
ALONE = frozenset(str.split("ms us µs μs ns sec msec usec millis micros seconds milliseconds microseconds"))  # of times
ABSOLUTE_WORDS = frozenset(str.split("unix epoch epoc utc timestamp"))  # of times that files of one trial share
SENSOR_NAMES = frozenset(  # of columns that state which sensor a row is from
    str.split(
        "device devicename deviceid deviceaddress sensor sensorname sensorid imu imuid imuname node nodeid mac "
        "macaddress address serial serialnumber 设备名称"
    )
)
COUNTERS = frozenset(
    str.split(
        "counter packetcounter samplecounter framecounter sample samplenumber sampleindex samplenr frame "
        "framenumber frameindex packet packetnumber index seq sequence sequencenumber count"
    )
)
SAMPLE_RATES = frozenset(
    str.split(
        "fs rate ratehz samplerate samplingrate samplefrequency samplingfrequency frequency freq sfreq srate "
        "updaterate fshz sampleratehz samplingratehz samplingfrequencyhz"
    )
)
AXES = {Quantity.QUAT: ("w", "x", "y", "z")}
XYZ = ("x", "y", "z")
SCALAR_FIRST = dict(zip("0123", "wxyz", strict=True))  # q0 is the scalar; where q1 to q4 have it is not agreed on

SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0, "d": 86_400.0}
SCALES: Mapping[Quantity, Mapping[str, float]] = {
    Quantity.ACC: FORCE_UNITS,
    Quantity.FREE_ACC: FORCE_UNITS,
    Quantity.GYR: RATE_UNITS,
    Quantity.TIME: SECONDS,
}
SPELLINGS: Mapping[Quantity, Mapping[str, str]] = {  # as `_plain_unit` leaves them
    Quantity.ACC: {
        **dict.fromkeys(("m/s2", "ms2", "m/s/s", "mss", "ms-2", "mps2", "m/sec2", "mpers2", "m/ss"), "m/s2"),
        **dict.fromkeys(("meter/s2", "meters/s2", "metres/s2", "meters/second2", "metres/second2"), "m/s2"),
        "g": "g",
        "mg": "mg",
    },
    Quantity.GYR: {
        **dict.fromkeys(("rad/s", "rads", "rad/sec", "radps", "rads-1", "radpers", "radians/s", "radian/s"), "rad/s"),
        **dict.fromkeys(("deg/s", "degs", "dps", "°/s", "°s-1", "deg/sec", "degps", "degs-1", "degpers"), "deg/s"),
        **dict.fromkeys(("degrees/s", "degree/s", "degrees/sec", "degree/second", "degrees/second"), "deg/s"),
        **dict.fromkeys(("d/s", "°/sec", "º/s", "â°/s", "grad/s"), "deg/s"),
        **dict.fromkeys(("mdeg/s", "mdps", "mdegs"), "mdeg/s"),
    },
    Quantity.TIME: {
        **dict.fromkeys(("s", "sec", "secs", "second", "seconds"), "s"),
        **dict.fromkeys(("ms", "msec", "millis", "millisec", "millisecond", "milliseconds"), "ms"),
        **dict.fromkeys(("us", "µs", "μs", "usec", "micros", "microsec", "microsecond", "microseconds"), "us"),
        **dict.fromkeys(("ns", "nsec", "nanos", "nanosecond", "nanoseconds"), "ns"),
        **dict.fromkeys(("min", "mins", "minute", "minutes"), "min"),
        **dict.fromkeys(("h", "hr", "hrs", "hour", "hours"), "h"),
        **dict.fromkeys(("d", "day", "days"), "d"),
    },
    Quantity.MAG: dict.fromkeys(("ut", "µt", "μt", "nt", "gauss", "ga", "mgauss", "au"), "any"),
    Quantity.QUAT: {},
}
MOST_UNIT_WORDS = 3  # "m", "per", "s2"
OTHER_UNITS = frozenset(str.split("m mm cm v mv counts count lsb adc raw rpm hz %"))  # in brackets; of none of these
SUPERSCRIPTS = str.maketrans({"²": "2", "¹": "1", "⁻": "-", "−": "-"})
LONGEST_NAME = 200
# what capitals, digits and signs divide; a digit stays with the letters before it
WORD = re.compile(r"[A-ZÀ-Þ]+(?![a-zß-ÿ])\d*|[A-ZÀ-Þ]?[a-zß-ÿµμ°]+\d*|\d+|[^\W_]")
MOST_NAMES, LONGEST_LISTED = 12, 40  # in a sentence


@dataclass(frozen=True, slots=True)
class NamedQuantity:
    """What one column's name states: `axis` empty where it names none, `unit` one of `SCALES` or empty."""

    sensor: str
    quantity: Quantity
    axis: str
    unit: str


@dataclass(frozen=True, slots=True)
class SensorColumns:
    """The names of one sensor's columns; `mag`, `quat`, `time` and `counter` empty where there are none."""

    sensor: str
    acc: tuple[str, ...]
    gyr: tuple[str, ...]
    mag: tuple[str, ...] = ()
    quat: tuple[str, ...] = ()
    time: str = ""
    counter: str = ""

    def names(self) -> tuple[str, ...]:
        """All of them."""
        return (*self.acc, *self.gyr, *self.mag, *self.quat, *filter(None, (self.time, self.counter)))


def plain_name(name: str) -> str:
    """A name in small letters, without what joins its words."""
    return re.sub(r"[\W_]+", "", name).lower()


def meaning_of(name: str, unit: str = "") -> NamedQuantity | None:
    """What a column's name states, with its unit where that is elsewhere; None where it is something else."""
    text, bracketed = without_brackets(name)
    plain = plain_name(text)
    if plain in COUNTERS:
        return NamedQuantity("", Quantity.COUNTER, "", "")
    if plain in SAMPLE_RATES:
        return NamedQuantity("", Quantity.SAMPLE_RATE, "", "")
    short = SHORT.fullmatch(text.strip().lower())
    if short and (text.strip() == short[0] or unit_of(LETTERS[short[1]], bracketed or unit)):
        text = "".join(short.groups())
    for phrase, word in PHRASES:
        text = re.sub(phrase, word, text, flags=re.IGNORECASE)
    spans = [(match.start(), match.end()) for match in WORD.finditer(text)]
    words = [text[start:end] for start, end in spans]
    if any(word.lower() in OTHER_WORDS for word in words):
        return None
    found = {at: stated for at, word in enumerate(words) if (stated := _stated_by(word)) is not None}
    if not found and words[:1] == ["t"] and (len(words) == 1 or unit_of(Quantity.TIME, "".join(words[1:]))):
        found = {0: (Quantity.TIME, "")}
    if not found and (elapsed := _elapsed_unit(words, bracketed or unit)):
        return NamedQuantity("", Quantity.TIME, "", elapsed)
    found = found or _axis_by_unit(words, bracketed or unit)
    times = {at: stated for at, stated in found.items() if stated[0] is Quantity.TIME}
    spent = {*found, *(at for at, word in enumerate(words) if word.lower() in EMPTY_WORDS)}
    found = times or found  # "gyroTimestamp"
    if len({quantity for quantity, _ in found.values()}) != 1:
        return None
    quantity = next(iter(found.values()))[0]
    axis = next((axis for _, axis in found.values() if axis), "")
    if not axis and quantity is not Quantity.TIME:
        at = next((k for k in reversed(range(len(words))) if k not in spent and _axis(quantity, words[k])), -1)
        axis = _axis(quantity, words[at]) if at >= 0 else ""
        spent.add(at)
    after = [k for k in range(min(found), len(words)) if k not in spent]
    spoken, of_unit = _spoken_unit(quantity, words, after)
    reported = next(filter(None, (unit_of(quantity, one) for one in (unit, bracketed))), "")
    return NamedQuantity(_left_of(text, spans, spent | of_unit), quantity, axis, reported or spoken)


def _axis_by_unit(words: Sequence[str], unit: str) -> dict[int, tuple[Quantity, str]]:
    """What the unit gives of a name that has an axis and no known word: "x-axis (deg/s)", "IMU 1 y [g]"."""
    axes = [(k, axis) for k, word in enumerate(words) if (axis := _axis(Quantity.ACC, word))]
    quantity = next((one for one in (Quantity.ACC, Quantity.GYR) if unit_of(one, unit)), None)
    if len(axes) != 1 or quantity is None or any(word.lower() in NOT_FELT for word in words):
        return {}
    return {axes[0][0]: (quantity, axes[0][1])}


def _elapsed_unit(words: Sequence[str], unit: str) -> str:
    """The unit of time of a name that has no other word for a quantity: "elapsed (s)", "seconds_elapsed"."""
    left = [word for word in words if word.lower() not in EMPTY_WORDS]
    if len(words) == 1 and words[0].lower() in ALONE:
        return unit_of(Quantity.TIME, words[0])
    if len(left) == len(words) or len(left) > 1:
        return ""
    return unit_of(Quantity.TIME, left[0] if left else unit)


def is_unit(text: str) -> bool:
    """Whether a text is a unit of any quantity."""
    return any(unit_of(quantity, text) for quantity in SPELLINGS)


def sensor_columns(names: Sequence[str], units: Mapping[str, str] | None = None) -> tuple[SensorColumns, ...]:
    """Find sensors with acceleration and rate about three axes; FileRefusedError for two columns alike."""
    return tuple(one for one in _columns_by_sensor(names, units or {}, None) if one.acc and one.gyr)


def half_columns(
    names: Sequence[str], units: Mapping[str, str] | None = None, of_file: Quantity | None = None
) -> tuple[SensorColumns, ...]:
    """Find sensors of which only acceleration or only rates are there, where no sensor is whole.

    `of_file`: what columns hold that name nothing but an axis. Raises FileRefusedError for two columns alike.
    """
    found = _columns_by_sensor(names, units or {}, of_file)
    if any(one.acc and one.gyr for one in found):
        return ()
    for gyr in [one for one in found if one.gyr]:
        _refuse_both([acc.acc[0] for acc in _other_halves(gyr, found)])
    return found


def quantity_of_file(stem: str) -> Quantity | None:
    """What a file's name states of its content: "lt_Gyroscope"; None for nothing, or for several quantities."""
    found = {stated for _, stated in _quantities_in(stem)}
    return found.pop() if len(found) == 1 else None


def without_quantity(stem: str) -> str:
    """A file's name without the quantity and rate in it: what the files of one sensor have in common."""
    stem = re.sub(r"[_\s-]*\d+(\.\d+)?\s?Hz", "", stem, flags=re.IGNORECASE)
    for word, _ in _quantities_in(stem):
        stem = re.sub(rf"(?:total)?[_\s-]*{re.escape(word)}", "", stem, flags=re.IGNORECASE)
    return stem.strip(" _-.")


def _quantities_in(stem: str) -> list[tuple[str, Quantity]]:
    """Words of a file's name and the quantity of each; magnetometers and the rest are none of a sensor's halves."""
    found: list[tuple[str, str]] = []
    for phrase, word in PHRASES:
        found += [(match[0], word.strip()) for match in re.finditer(phrase, stem, re.IGNORECASE)]
        stem = re.sub(phrase, "\0", stem, flags=re.IGNORECASE)
    found += [(word, word.lower()) for word in WORD.findall(stem)]
    halves = (Quantity.ACC, Quantity.FREE_ACC, Quantity.GYR)
    return [(word, WORDS[meant]) for word, meant in found if WORDS.get(meant) in halves]


def _columns_by_sensor(
    names: Sequence[str], units: Mapping[str, str], of_file: Quantity | None
) -> tuple[SensorColumns, ...]:
    """All sensors of which acceleration, rates or both are there."""
    meant = {name: meaning for name in names if (meaning := meaning_of(name, units.get(name, ""))) is not None}
    for name in names:
        if of_file is not None and name not in meant and name.strip().lower() in XYZ:
            meant[name] = NamedQuantity("", of_file, name.strip().lower(), "")
    places: dict[tuple[str, Quantity], dict[str, list[str]]] = {}
    called: dict[str, str] = {}
    for name, meaning in meant.items():
        key = meaning.sensor.casefold()
        called.setdefault(key, meaning.sensor)
        places.setdefault((key, meaning.quantity), {}).setdefault(meaning.axis, []).append(name)

    def whole(key: str, quantity: Quantity) -> tuple[str, ...]:
        axes = places.get((key, quantity), {})
        required = AXES.get(quantity, XYZ)
        if not all(axis in axes for axis in required):
            return ()
        for axis in required:
            _refuse_both(axes[axis])
        return tuple(axes[axis][0] for axis in required)

    sensors = []
    for key, sensor in called.items():
        acc = whole(key, Quantity.ACC) or whole(key, Quantity.FREE_ACC)
        gyr = whole(key, Quantity.GYR)
        if not acc and not gyr:
            continue
        sensors.append(
            SensorColumns(
                sensor,
                acc,
                gyr,
                whole(key, Quantity.MAG),
                whole(key, Quantity.QUAT),
                _one_time(places, meant, key),
                next(iter(places.get(("", Quantity.COUNTER), {}).get("", [])), ""),
            )
        )
    return tuple(_put_together(sensors))


def _put_together(sensors: Sequence[SensorColumns]) -> list[SensorColumns]:
    """Make one sensor of two halves of which one has more words in its name: "Total acc x", "gyro x"."""
    found = list(sensors)
    for acc in [one for one in sensors if one.acc and not one.gyr]:
        (gyr, *more) = _other_halves(acc, sensors) or [acc]
        if (
            gyr is acc
            or more
            or len(_other_halves(gyr, sensors)) > 1
            or (acc.time != gyr.time and acc.time and gyr.time)
        ):
            continue
        whole = replace(
            gyr,
            sensor=min(acc.sensor, gyr.sensor, key=len),
            acc=acc.acc,
            mag=gyr.mag or acc.mag,
            quat=gyr.quat or acc.quat,
            time=gyr.time or acc.time,
        )
        found = [whole if one is gyr else one for one in found if one is not acc]
    return found


def _other_halves(half: SensorColumns, sensors: Sequence[SensorColumns]) -> list[SensorColumns]:
    """Halves of the other quantity whose name is this one's with more words, or with fewer."""

    def words(one: SensorColumns) -> set[str]:
        return {word.casefold() for word in WORD.findall(one.sensor)}

    others = [one for one in sensors if not (one.acc and one.gyr) and bool(one.acc) != bool(half.acc)]
    return [one for one in others if words(half) <= words(one) or words(half) >= words(one)]


def _one_time(
    places: Mapping[tuple[str, Quantity], Mapping[str, list[str]]], meant: Mapping[str, NamedQuantity], key: str
) -> str:
    """The column of times of a sensor, or of all: one that names its unit, and rather one that files share."""
    for owner in (key, ""):
        names = places.get((owner, Quantity.TIME), {}).get("", [])
        reported = [name for name in names if meant[name].unit] or names
        shared = [name for name in reported if ABSOLUTE_WORDS & {word.lower() for word in WORD.findall(name)}]
        if reported:
            return (shared or reported)[0]
    return ""


def time_among(names: Sequence[str], units: Mapping[str, str]) -> str:
    """The column of times by its name, of all sensors; empty where there is none."""
    meant = {name: meaning for name in names if (meaning := meaning_of(name, units.get(name, ""))) is not None}
    times = [name for name, one in meant.items() if one.quantity is Quantity.TIME and not one.sensor]
    return _one_time({("", Quantity.TIME): {"": times}}, meant, "") if times else ""


def _refuse_both(names: Sequence[str]) -> None:
    if len(names) > 1:
        raise FileRefusedError(
            "", "the columns {names} have the same meaning", "Remove all but one of these columns", names=listed(names)
        )


def without_brackets(name: str) -> tuple[str, str]:
    """The name without the unit in its brackets, and that unit; brackets that hold something else are opened."""
    name, unit = name[:LONGEST_NAME], ""
    for bracket in re.findall(r"\[[^\[\]]*\]|\([^()]*\)", name):
        content = bracket[1:-1].strip()
        if is_unit(content) or "/" in content or content.lower() in OTHER_UNITS:
            name, unit = name.replace(bracket, " "), content
    return re.sub(r"[\[\](){}]", " ", name), unit


def _left_of(text: str, spans: Sequence[tuple[int, int]], spent: Collection[int]) -> str:
    """A name without the words that are spent: what it calls the sensor, as it is written there."""
    for at in spent:
        if at >= 0:
            start, end = spans[at]
            text = text[:start] + "\0" * (end - start) + text[end:]
    pieces = (re.sub(r"^[\W_]+|[\W_]+$", "", piece) for piece in text.split("\0"))
    return "_".join(filter(None, pieces))


def _stated_by(word: str) -> tuple[Quantity, str] | None:
    """The quantity and the axis that one word names: "Acc", "accx", "q0"."""
    lower = word.lower()
    if lower in WORDS:
        return WORDS[lower], ""
    quantity = LETTERS.get(lower[:-1]) or WORDS.get(lower[:-1])
    axis = "" if quantity is None or quantity is Quantity.TIME else _axis(quantity, lower[-1])
    return (quantity, axis) if quantity is not None and axis else None


def _axis(quantity: Quantity, word: str) -> str:
    """The axis that a word names; empty where it names none."""
    lower = word.lower()
    if quantity is Quantity.QUAT:
        lower = SCALAR_FIRST.get(lower, lower)
    return lower if lower in AXES.get(quantity, XYZ) else ""


def _spoken_unit(quantity: Quantity, words: Sequence[str], after: Sequence[int]) -> tuple[str, set[int]]:
    """The unit that words after the quantity make, and which words these are: the last, else the first."""
    for many in range(min(MOST_UNIT_WORDS, len(after)), 0, -1):
        for chosen in (after[-many:], after[:many]):
            if unit := unit_of(quantity, "".join(words[k] for k in chosen)):
                return unit, set(chosen)
    return "", set()


def unit_of(quantity: Quantity, text: str) -> str:
    """The unit of a quantity that a text means, one of `SCALES`; empty where it means none."""
    known = SPELLINGS.get(Quantity.ACC if quantity is Quantity.FREE_ACC else quantity, {})
    return known.get(_plain_unit(text), "")


def _plain_unit(text: str) -> str:
    return re.sub(r"[\s_^*·.()]|\\", "", text.strip().strip("[](){}").lower()).translate(SUPERSCRIPTS)


def listed(names: Sequence[str]) -> str:
    """Names as they can stand in a sentence."""
    more = f" (+{len(names) - MOST_NAMES})" if len(names) > MOST_NAMES else ""
    return ", ".join(map(_short, names[:MOST_NAMES])) + more


def _short(name: str) -> str:
    """A long name without its middle: axis and unit are at its end."""
    return name if len(name) <= LONGEST_LISTED else f"{name[: LONGEST_LISTED - 21]}…{name[-20:]}"

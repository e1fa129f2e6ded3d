"""Topics of the manual. Its pages are files of `resources/help`, one folder below it for each other language."""

from enum import StrEnum
from importlib.resources import files
from pathlib import Path

from app.wording.translation import spoken_language, tr

FOLDER = Path(str(files("resources") / "help"))


class Topic(StrEnum):
    """The pages of the manual in their order; each is a file of `resources/help`, and a step names it as its topic."""

    FIRST_REPORT = "first-report"
    HOME = "home"
    PATIENT = "patient"
    SENSORS = "sensors"
    STAND_STILL = "stand-still"
    FREE_MOTION = "free-motion"
    WALKING = "walking"
    RESULTS = "results"
    REPORT = "report"
    NUMBERS = "what-numbers-say"
    COMPARE = "compare"
    GOALS = "goals"
    ACCURACY = "accuracy"
    BENCH = "bench"
    TIMED_TESTS = "timed-tests"
    PATIENT_SCREEN = "patient-screen"
    VIDEO = "video"
    PELVIS = "pelvis"
    QUESTIONS = "questions"
    REPEATABILITY = "repeatability"
    FILES = "files"
    LIVE_OUTPUT = "live-output"
    PRIVACY = "privacy"
    ADMINISTRATION = "administration"
    STATIONS = "stations"
    COMMAND_LINE = "command-line"
    OTHER_PACKAGES = "other-packages"
    MESSAGES = "messages"
    GLOSSARY = "glossary"
    KEYS = "keys"
    ACCESSIBILITY = "accessibility"
    SENSORS_XIMU3 = "sensors-ximu3"
    SENSORS_WITMOTION = "sensors-witmotion"
    SENSORS_CSV = "sensors-csv"
    SENSORS_XSENS_MTI = "sensors-xsens-mti"
    SENSORS_SHIMMER3 = "sensors-shimmer3"
    SENSORS_MOVELLA_DOT = "sensors-movella-dot"
    SENSORS_LSL = "sensors-lsl"


class TopicGroup(StrEnum):
    """What pages that stand together have in common; the value names the first of them."""

    BEGIN = Topic.FIRST_REPORT
    SESSION = Topic.PATIENT
    READING = Topic.NUMBERS
    MORE = Topic.BENCH
    DATA = Topic.FILES
    LOOKING_UP = Topic.MESSAGES
    MAKERS = Topic.SENSORS_XIMU3


def group_title(group: TopicGroup) -> str:
    return {
        TopicGroup.BEGIN: tr("Start"),
        TopicGroup.SESSION: tr("Session"),
        TopicGroup.READING: tr("Results and comparison"),
        TopicGroup.MORE: tr("More functions"),
        TopicGroup.DATA: tr("Data and operation"),
        TopicGroup.LOOKING_UP: tr("More help"),
        TopicGroup.MAKERS: tr("Supported sensors"),
    }[group]


def topic_title(topic: Topic) -> str:
    return {
        Topic.FIRST_REPORT: tr("First report in five minutes"),
        Topic.HOME: tr("Patients"),
        Topic.PATIENT: tr("Patient"),
        Topic.SENSORS: tr("Sensors"),
        Topic.STAND_STILL: tr("Stand still"),
        Topic.FREE_MOTION: tr("Free motion"),
        Topic.WALKING: tr("Walking"),
        Topic.RESULTS: tr("Results"),
        Topic.REPORT: tr("Report"),
        Topic.NUMBERS: tr("Interpreting the numbers"),
        Topic.COMPARE: tr("Compare"),
        Topic.GOALS: tr("Goals"),
        Topic.ACCURACY: tr("Accuracy"),
        Topic.BENCH: tr("Alignment"),
        Topic.TIMED_TESTS: tr("Timed tests"),
        Topic.PATIENT_SCREEN: tr("Patient screen"),
        Topic.VIDEO: tr("Video"),
        Topic.PELVIS: tr("Pelvis and hips"),
        Topic.QUESTIONS: tr("Cohort"),
        Topic.REPEATABILITY: tr("Repeatability"),
        Topic.FILES: tr("Files"),
        Topic.LIVE_OUTPUT: tr("Live output"),
        Topic.PRIVACY: tr("Data and privacy"),
        Topic.ADMINISTRATION: tr("For administrators"),
        Topic.STATIONS: tr("Several workstations"),
        Topic.COMMAND_LINE: tr("Command line"),
        Topic.OTHER_PACKAGES: tr("Other packages and scripts"),
        Topic.MESSAGES: tr("Messages explained"),
        Topic.GLOSSARY: tr("Glossary"),
        Topic.KEYS: tr("Keys"),
        Topic.ACCESSIBILITY: tr("Accessibility"),
        Topic.SENSORS_XIMU3: "x-IMU3",
        Topic.SENSORS_WITMOTION: "WitMotion",
        Topic.SENSORS_CSV: tr("Text lines (CSV)"),
        Topic.SENSORS_XSENS_MTI: tr("Xsens MTi"),
        Topic.SENSORS_SHIMMER3: "Shimmer3",
        Topic.SENSORS_MOVELLA_DOT: tr("Movella DOT"),
        Topic.SENSORS_LSL: tr("Lab Streaming Layer"),
    }[topic]


def help_file(name: str) -> Path:
    """The file of this name in the language that is spoken, in English where it has none."""
    spoken = FOLDER / spoken_language() / name
    return spoken if spoken.is_file() else FOLDER / name

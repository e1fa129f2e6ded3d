"""What is the manual about? Its pages, as files of `resources/help`, one folder below it for each other language."""

from enum import StrEnum
from functools import cache
from importlib.resources import files
from pathlib import Path

from PySide6.QtGui import QTextDocument

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
    PELVIS = "pelvis"
    QUESTIONS = "questions"
    FILES = "files"
    PRIVACY = "privacy"
    ADMINISTRATION = "administration"
    STATIONS = "stations"
    MESSAGES = "messages"
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
        TopicGroup.BEGIN: tr("Begin"),
        TopicGroup.SESSION: tr("A session"),
        TopicGroup.READING: tr("Reading and comparing"),
        TopicGroup.MORE: tr("More than a walk"),
        TopicGroup.DATA: tr("Data and keeping"),
        TopicGroup.LOOKING_UP: tr("To look up"),
        TopicGroup.MAKERS: tr("Sensors by maker"),
    }[group]


def topic_title(topic: Topic) -> str:
    return {
        Topic.FIRST_REPORT: tr("The first report in five minutes"),
        Topic.HOME: tr("Patients"),
        Topic.PATIENT: tr("Patient"),
        Topic.SENSORS: tr("Sensors"),
        Topic.STAND_STILL: tr("Stand still"),
        Topic.FREE_MOTION: tr("Free motion"),
        Topic.WALKING: tr("Walking"),
        Topic.RESULTS: tr("Results"),
        Topic.REPORT: tr("Report"),
        Topic.NUMBERS: tr("What the numbers can say"),
        Topic.COMPARE: tr("Compare"),
        Topic.GOALS: tr("Goals"),
        Topic.ACCURACY: tr("Accuracy"),
        Topic.BENCH: tr("Bench"),
        Topic.TIMED_TESTS: tr("Timed tests"),
        Topic.PATIENT_SCREEN: tr("Patient's screen"),
        Topic.PELVIS: tr("Pelvis and hips"),
        Topic.QUESTIONS: tr("Questions"),
        Topic.FILES: tr("Files"),
        Topic.PRIVACY: tr("Data and privacy"),
        Topic.ADMINISTRATION: tr("For administrators"),
        Topic.STATIONS: tr("Several stations"),
        Topic.MESSAGES: tr("What messages mean"),
        Topic.KEYS: tr("Keys"),
        Topic.ACCESSIBILITY: tr("Accessibility"),
        Topic.SENSORS_XIMU3: "x-IMU3",
        Topic.SENSORS_WITMOTION: "WitMotion",
        Topic.SENSORS_CSV: tr("Lines of numbers"),
        Topic.SENSORS_XSENS_MTI: tr("Xsens MTi"),
        Topic.SENSORS_SHIMMER3: "Shimmer3",
        Topic.SENSORS_MOVELLA_DOT: tr("Movella DOT"),
        Topic.SENSORS_LSL: tr("Lab Streaming Layer"),
    }[topic]


def help_file(name: str) -> Path:
    """The file of this name in the language that is spoken, in English where it has none."""
    spoken = FOLDER / spoken_language() / name
    return spoken if spoken.is_file() else FOLDER / name


def markdown_of(topic: Topic) -> str:
    return help_file(f"{topic}.md").read_text(encoding="utf-8")


def plain_words_of(topic: Topic) -> str:
    """Give the words of a topic alone, in small letters, to search in."""
    return _plain_words(help_file(f"{topic}.md"))


@cache
def _plain_words(file: Path) -> str:
    document = QTextDocument()
    document.setMarkdown(file.read_text(encoding="utf-8"), QTextDocument.MarkdownFeature.MarkdownDialectGitHub)
    return document.toPlainText().casefold()

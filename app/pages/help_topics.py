"""What is the manual about? Its pages, as files of `resources/help`."""

from enum import StrEnum
from functools import cache
from importlib.resources import files
from pathlib import Path

from PySide6.QtGui import QTextDocument

from app.wording import tr

FOLDER = Path(str(files("resources") / "help"))


class Topic(StrEnum):
    """The pages of the manual in their order; each is a file of `resources/help`, and a step names it as its topic."""

    HOME = "home"
    PATIENT = "patient"
    SENSORS = "sensors"
    STAND_STILL = "stand-still"
    FREE_MOTION = "free-motion"
    WALKING = "walking"
    RESULTS = "results"
    REPORT = "report"
    GOALS = "goals"
    QUESTIONS = "questions"
    ACCURACY = "accuracy"
    STATIONS = "stations"
    MESSAGES = "messages"
    KEYS = "keys"
    SENSORS_XIMU3 = "sensors-ximu3"
    SENSORS_WITMOTION = "sensors-witmotion"
    SENSORS_CSV = "sensors-csv"
    SENSORS_XSENS_MTI = "sensors-xsens-mti"
    SENSORS_SHIMMER3 = "sensors-shimmer3"
    SENSORS_MOVELLA_DOT = "sensors-movella-dot"
    SENSORS_LSL = "sensors-lsl"


def topic_title(topic: Topic) -> str:
    return {
        Topic.HOME: tr("Patients"),
        Topic.PATIENT: tr("Patient"),
        Topic.SENSORS: tr("Sensors"),
        Topic.STAND_STILL: tr("Stand still"),
        Topic.FREE_MOTION: tr("Free motion"),
        Topic.WALKING: tr("Walking"),
        Topic.RESULTS: tr("Results"),
        Topic.REPORT: tr("Report"),
        Topic.GOALS: tr("Goals"),
        Topic.QUESTIONS: tr("Questions"),
        Topic.ACCURACY: tr("Accuracy"),
        Topic.STATIONS: tr("Several stations"),
        Topic.MESSAGES: tr("What messages mean"),
        Topic.KEYS: tr("Keys"),
        Topic.SENSORS_XIMU3: "x-IMU3",
        Topic.SENSORS_WITMOTION: "WitMotion",
        Topic.SENSORS_CSV: tr("Lines of numbers"),
        Topic.SENSORS_XSENS_MTI: tr("Xsens MTi"),
        Topic.SENSORS_SHIMMER3: "Shimmer3",
        Topic.SENSORS_MOVELLA_DOT: tr("Movella DOT"),
        Topic.SENSORS_LSL: tr("Lab Streaming Layer"),
    }[topic]


def markdown_of(topic: Topic) -> str:
    return (FOLDER / f"{topic}.md").read_text(encoding="utf-8")


@cache
def plain_words_of(topic: Topic) -> str:
    """Give the words of a topic alone, in small letters, to search in."""
    document = QTextDocument()
    document.setMarkdown(markdown_of(topic), QTextDocument.MarkdownFeature.MarkdownDialectGitHub)
    return document.toPlainText().casefold()

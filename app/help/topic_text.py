"""What the topics of the manual say: as it is shown, and in plain words to search in.

Apart from their names, which the window has from its start: the captions are those of the films, which draw.
"""

from functools import cache

from PySide6.QtGui import QTextDocument

from app.films.film import with_captions
from app.help.help_topics import Topic, help_file
from app.wording.translation import spoken_language


def markdown_of(topic: Topic) -> str:
    """Give a topic as it is shown: its file, with the captions of its films."""
    return with_captions(help_file(f"{topic}.md").read_text(encoding="utf-8"))


def plain_words_of(topic: Topic) -> str:
    """Give the words of a topic alone, in small letters, to search in."""
    return _plain_words(topic, spoken_language())


@cache
def _plain_words(topic: Topic, _language: str) -> str:
    document = QTextDocument()
    document.setMarkdown(markdown_of(topic), QTextDocument.MarkdownFeature.MarkdownDialectGitHub)
    return document.toPlainText().casefold()

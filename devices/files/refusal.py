"""The refusal of a file that is not what it claims to be."""

from collections.abc import Mapping


class FileRefusedError(Exception):
    """A file that cannot be used: what is wrong, where, and what to do, as one line for the person who chose it.

    `where` is the file as the reader knows it, with a line or a time where there is one; `what` a clause,
    `remedy` a sentence without its full stop: written out as of `devices.live.SourceRefusedError`, with `values` for
    their braces. What files hold ends up in these words, so whatever would break the line is made visible or dropped.
    """

    def __init__(self, where: str, what: str, remedy: str, **values: object) -> None:
        self.where, self.what, self.remedy = one_line(where), one_line(what), one_line(remedy)
        self.values = {key: one_line(str(value)) for key, value in values.items()}
        stated = f"{self.what}. {self.remedy}."
        super().__init__(f"{self.where}: {stated.format(**self.values) if values else stated}")

    @classmethod
    def stated_elsewhere(cls, where: str, what: str, remedy: str, values: Mapping[str, str]) -> "FileRefusedError":
        """The refusal of another process, or with the remedy of whoever asks, in their words."""
        return cls(where, what, remedy, **values)


def one_line(text: str) -> str:
    """Text without anything that breaks a line or a terminal."""
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())


def plain(value: float, digits: int = 12) -> str:
    """A number without an exponent: so many digits of it, and all that are before its point."""
    return f"{value:.{digits}g}" if abs(value) < 10.0**digits else f"{value:.0f}"


def quoted(value: object, longest: int = 40) -> str:
    """`value` as it can be shown inside a sentence; the end of a long text is left off."""
    text = one_line(str(value))
    return f'"{text}"' if len(text) <= longest else f'"{text[:longest]}..."'

"""The site's page of the command line, made of the parser itself: each subcommand with all that it takes."""

import argparse
import re
from collections.abc import Callable, Iterator

WIDTH = 72  # of a usage
USAGE = "usage: "
LISTS = (  # of words that are typed, in `app.cli.arguments`
    *("PAPERS", "KINDS", "ENCODINGS", "SEPARATORS", "DECIMALS", "FORCE_UNITS", "RATE_UNITS", "TIME_UNITS", "MODELS"),
    *("EXPORTED", "IMPORTED", "TYPED"),
)
LITERAL = re.compile(
    r"--locale de|--[a-z][a-z-]*|library:ID|knee_range_deg=5|[a-z0-9]+://[\w./:@]*\w|OUT/session"
    r"|\b[\w-]+\.(?:csv|json|pdf|xlsx|parquet|rrd|xml)\b"
)


def commands_page() -> str:
    """Every subcommand, argument and option with its help text."""
    from app.cli.parser import SUBCOMMANDS, Parser, add_language

    whole = Parser(prog="gaitwright", formatter_class=_formatter)
    add_language(whole)
    head = (
        "# Every command\n\n`gaitwright SUBCOMMAND` does without a window what the window does. This page is made of "
        "the program's own help: `gaitwright SUBCOMMAND --help` prints the same. What the subcommands are for, "
        "environment variables and exit codes: [Command line](../manual/command-line.md).\n\n"
        f"## Before a subcommand\n\n{_table(whole)}\n"
    )
    rows = "".join(f"| [`{name}`](#{name}) | {_sentence(what)} |\n" for name, (what, _) in SUBCOMMANDS.items())
    listed = f"\n## Subcommands\n\n| Subcommand | What it does |\n|---|---|\n{rows}\n"
    return head + listed + "".join(_section(name, add) for name, (_, add) in SUBCOMMANDS.items())


def _section(name: str, add_arguments: Callable[[argparse.ArgumentParser], None]) -> str:
    from app.cli.parser import Parser

    parser = Parser(prog=f"gaitwright {name}", formatter_class=_formatter)
    add_arguments(parser)
    parts = [f"## {name}\n\n{parser.description}\n\n{_usage(parser)}\n\n{_table(parser)}\n"]
    for action in _subparsers(parser):
        helps = {one.dest: one.help or "" for one in action._choices_actions}
        for chosen, below in action.choices.items():
            below.formatter_class = _formatter
            parts.append(f"### {name} {chosen}\n\n{_sentence(helps[chosen])}\n\n{_usage(below)}\n\n{_table(below)}\n")
    return "\n".join(parts) + "\n"


def _formatter(prog: str) -> argparse.HelpFormatter:
    return argparse.HelpFormatter(prog, width=WIDTH + len(USAGE))


def _usage(parser: argparse.ArgumentParser) -> str:
    """The usage without its first word, and every further line to the left by as much."""
    lines = parser.format_usage().rstrip().splitlines()
    return "\n".join(["```text", *(line[len(USAGE) :] for line in lines), "```"])


def _table(parser: argparse.ArgumentParser) -> str:
    rows = [
        f"| {_names(action)}{', required' if _is_required(action) else ''} | {_meaning(action.help or '')} |"
        for action in parser._actions
        if not isinstance(action, argparse._HelpAction)
    ]
    listed = "\n".join(["| Argument | Meaning |", "|---|---|", *rows])
    return f'<div class="arguments" markdown>\n\n{listed}\n\n</div>\n'


def _is_required(action: argparse.Action) -> bool:
    return action.required and action.nargs not in ("?", "*")


def _names(action: argparse.Action) -> str:
    """The option with what follows it, or the name of a place; `metavar` as the program prints it."""
    choices = f"{{{','.join(map(str, action.choices))}}}" if action.choices else ""
    value = str(action.metavar or choices or action.dest.upper())
    if not action.option_strings:
        return f"`{value}`{', one or more' if action.nargs == '+' else ''}"
    takes = "" if action.nargs == 0 else f" [{value}]" if action.nargs == "?" else f" {value}"
    return ", ".join(f"`{option}{takes}`" for option in action.option_strings)


def _subparsers(parser: argparse.ArgumentParser) -> "Iterator[argparse._SubParsersAction[argparse.ArgumentParser]]":
    return (action for action in parser._actions if isinstance(action, argparse._SubParsersAction))


def _sentence(text: str) -> str:
    return text[:1].upper() + text[1:] + ("." if text and text[-1] not in ".?)" else "")


def _meaning(text: str) -> str:
    """A help text as a cell of a table: what is typed stays as it is typed, in code."""
    from app.cli import arguments

    for name in LISTS:
        words = tuple(getattr(arguments, name))
        typed = ", ".join(f"`{word}`" for word in words)
        text = text.replace(" | ".join(words), typed).replace(", ".join(words), typed)
    parts = re.split(r"(`[^`]*`)", text)  # what is code already is at the odd places
    parts[::2] = [LITERAL.sub(r"`\g<0>`", part).replace("|", "\\|").replace("<", "&lt;") for part in parts[::2]]
    return _sentence("".join(parts))

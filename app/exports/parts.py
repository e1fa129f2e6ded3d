"""Names of the files of a recording that one file cannot hold."""

from pathlib import Path


def part_paths(path: Path, parts: int) -> list[Path]:
    """The file of each part: the file itself where it is whole, else angles_1, angles_2 and so on."""
    if parts == 1:
        return [path]
    return [path.with_name(f"{path.stem}_{number}{path.suffix}") for number in range(1, parts + 1)]

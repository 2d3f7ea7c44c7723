"""Pages of the documentation as programs: their code in order, and what each page says is printed."""

from __future__ import annotations

import math
import os
import re
import shlex
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[1]
# Of libraries that only a robot's own distribution has.
STAND_INS = ROOT / "tests" / "stand_ins"
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[+-]?\d+)?(?!\w|\.\d)")
# A line of a page in place of any number of printed lines.
OMITTED = "..."
# Printed between blocks.
END = "\x1e"
# Numbers of a page may differ from printed ones: computers round differently, and estimates pass it on.
RELATIVE, LAST_PLACES = 0.05, 2
# Columns of the terminal that the pages show.
WIDTH = "100"


@dataclass(frozen=True)
class Block:
    """Code of a page, and the text that the page shows as its output; None where it shows none."""

    language: str
    code: str
    stated: str | None


def blocks(page: Path) -> list[Block]:
    """The blocks of Python and of the shell, in order."""
    found = BLOCK.findall(page.read_text(encoding="utf-8"))
    following = [*found[1:], ("", "")]
    return [
        Block(language, code, after[1] if after[0] == "text" else None)
        for (language, code), after in zip(found, following, strict=True)
        if language in ("python", "sh")
    ]


def commands(code: str) -> list[str]:
    """Commands of a block of the shell, one a line; lines that end in a backslash go on."""
    return [line for line in code.replace("\\\n", " ").splitlines() if line.strip()]


def run_page(page: Path, folder: Path, timeout: float = 120.0) -> list[str]:
    """Runs a page as one program in a folder, with warnings as errors; what each block prints."""
    code = "".join(_python(block) for block in blocks(page))
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", code],
        cwd=folder,
        env=environment(folder),
        capture_output=True,
        text=True,
        timeout=timeout,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stderr == ""
    return done.stdout.split(END + "\n")[:-1]


def _python(block: Block) -> str:
    if block.language == "python":
        return f"{block.code}\nprint({END!r}, flush=True)\n"
    runs = "\n".join(
        f"__import__('subprocess').run({shlex.split(command)!r}, check=True, stderr=-2)"
        for command in commands(block.code)
        if not command.startswith("pip ")
    )
    return f"{runs}\nprint({END!r}, flush=True)\n"


def environment(folder: Path) -> dict[str, str]:
    """With the command `contactsense` of this Python, and a terminal of a known width."""
    programs = folder.parent / f"{folder.name}-bin"
    programs.mkdir(exist_ok=True)
    command = programs / "contactsense"
    command.write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} -m contactsense "$@"\n')
    command.chmod(0o755)
    paths = [str(STAND_INS), *filter(None, [os.environ.get("PYTHONPATH")])]
    return {
        **os.environ,
        "PYTHONPATH": os.pathsep.join(paths),
        "PATH": f"{programs}{os.pathsep}{os.environ['PATH']}",
        "COLUMNS": WIDTH,
        "MPLBACKEND": "Agg",
    }


def differences(stated: str, printed: str) -> list[str]:
    """Lines of a page that were not printed so, up to the last digits of numbers."""
    wanted = [line.split() for line in stated.splitlines() if line.strip()]
    rows = [line.split() for line in printed.splitlines() if line.strip()]
    missing, row, free = [], 0, False
    for line in wanted:
        if line == [OMITTED]:
            free = True
            continue
        ahead = range(row, len(rows)) if free else range(row, min(row + 1, len(rows)))
        found = next((index for index in ahead if _alike(" ".join(line), " ".join(rows[index]))), None)
        if found is None:
            missing.append(" ".join(line))
            free = True
        else:
            row, free = found + 1, False
    if row < len(rows) and not free:
        missing.append(f"(not on the page) {' '.join(rows[row])}")
    return missing


def _alike(stated: str, printed: str) -> bool:
    if NUMBER.sub("#", stated) != NUMBER.sub("#", printed):
        return False
    pairs = zip(NUMBER.findall(stated), NUMBER.findall(printed), strict=True)
    return all(_near(*pair) for pair in pairs)


def _near(stated: str, printed: str) -> bool:
    mantissa, _, exponent = stated.partition("e")
    place = 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))
    # Whole numbers may be counts.
    units = LAST_PLACES if "." in mantissa else 0
    return math.isclose(float(stated), float(printed), rel_tol=RELATIVE, abs_tol=1.001 * units * place)

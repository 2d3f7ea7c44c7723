"""The notebook of the examples with its output: `python -m tools.notebook` runs it anew and saves it.

With `--check`, nothing is saved: its cells must run, and print what the saved ones did but for the numbers.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

import nbformat
from nbclient import NotebookClient

NOTEBOOK = Path(__file__).parents[1] / "examples" / "contact_step_by_step.ipynb"
# Of a cell [s].
TIMEOUT = 300


def executed() -> nbformat.NotebookNode:
    """The notebook with new output."""
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    NotebookClient(notebook, timeout=TIMEOUT, record_timing=False).execute()
    return notebook


def said(notebook: nbformat.NotebookNode) -> list[list[str]]:
    """What each cell printed, without numbers, and the kinds of its pictures."""
    return [_said(cell.outputs) for cell in notebook.cells if cell.cell_type == "code"]


def _said(outputs: list[nbformat.NotebookNode]) -> list[str]:
    """One text a stream between two pictures, since the kernel may send what is printed in several parts."""
    told: list[list[str]] = []
    for output in outputs:
        if output.output_type != "stream":
            told.append(["picture", " ".join(sorted(output.data))])
        elif told and told[-1][0] == output.name:
            told[-1][1] += output.text
        else:
            told.append([output.name, output.text])
    return [f"{kind}: {re.sub(r'[-+ ]*[0-9][0-9.]*', '#', text)}" for kind, text in told]


def main() -> int:
    """Runs the notebook; with `--check`, compares it with the saved one."""
    notebook = executed()
    if "--check" in sys.argv[1:]:
        before = said(nbformat.read(NOTEBOOK, as_version=4))
        if before != said(notebook):
            print(f"saved:   {before}\nprinted: {said(notebook)}", file=sys.stderr)
            return 1
    else:
        nbformat.write(notebook, NOTEBOOK)
    return 0


if __name__ == "__main__":
    sys.exit(main())

"""Pictures: colours, one style, and whether they can be written before the work that they show is done."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ._extras import require
from .errors import InputError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Colours that stay apart for colour-blind eyes (Okabe and Ito 2008).
TRUTH = "#000000"
ESTIMATE = "#D55E00"
DETECTED = "#0072B2"
GREY = "#999999"
TEXT = "#444444"
BODY = "#C9CDD2"
NAMED = "#56B4E9"
WRONG = "#CC79A7"
UNSURE = "#E69F00"
# By joint, base to tip.
JOINTS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#8A8200")

_STYLE: Any = {
    "font.size": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": GREY,
    "axes.titlesize": 11,
    "axes.titlelocation": "left",
}
_RESOLUTION = 130  # [dots an inch]


def picture_file(argument: str, path: str | os.PathLike[str]) -> Path:
    """The absolute path of a picture to be written; ".png" is added where there is no suffix.

    Raises:
        InputError: it cannot be written; names `argument`.
    """
    from matplotlib.backend_bases import FigureCanvasBase

    target = Path(path).resolve()
    if target.is_dir():
        raise InputError(
            f"{argument}: '{path}' is a folder; name a file in it, such as '{Path(path) / 'a.png'}'"
        )
    target = target if target.suffix else target.with_suffix(".png")
    kinds = FigureCanvasBase.get_supported_filetypes()
    if target.suffix[1:].lower() not in kinds:
        known = ", ".join(f".{kind}" for kind in kinds)
        raise InputError(f"{argument}: cannot write '{path}': it must end in one of {known}")
    if not target.parent.is_dir():
        raise InputError(f"{argument}: cannot write '{path}': there is no folder '{target.parent}'")
    if not os.access(target if target.exists() else target.parent, os.W_OK):
        raise InputError(f"{argument}: cannot write '{path}': permission denied")
    return target


def optional_picture(argument: str, path: Path | None) -> Path | None:
    """`picture_file` of a picture that is drawn where a path is given.

    Raises:
        InputError: it cannot be written; names `argument`.
        MissingExtraError: matplotlib is not installed.
    """
    if path is None:
        return None
    require("plot", "matplotlib")
    return picture_file(argument, path)


def picture_folder(argument: str, path: str | os.PathLike[str]) -> Path:
    """A folder for pictures, made if need be.

    Raises:
        InputError: pictures cannot be written there; names `argument`.
    """
    folder = Path(path)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as cause:
        raise InputError(f"{argument}: '{path}' cannot be a folder for pictures: {cause.strerror}") from cause
    if not os.access(folder, os.W_OK):
        raise InputError(f"{argument}: cannot write into '{path}': permission denied")
    return folder


def legend_above(axes: Axes) -> None:
    """Puts a legend of one line above a plot, at its right end: it hides nothing."""
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=9, frameon=False, borderaxespad=0.2)


def save_picture(
    argument: str,
    path: Path,
    size: tuple[float, float],
    draw: Callable[[Figure], object],
    *,
    constrained: bool = True,
) -> Path:
    """Lets `draw` fill a figure of `size` [inch] and writes it to `path`, which is returned.

    Raises:
        InputError: the file cannot be written; names `argument`.
    """
    import matplotlib
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    with matplotlib.rc_context(_STYLE):
        figure = Figure(figsize=size, layout="constrained" if constrained else None)
        FigureCanvasAgg(figure)
        draw(figure)
        try:
            figure.savefig(path, dpi=_RESOLUTION, facecolor="white")
        except (OSError, ValueError) as cause:
            raise InputError(f"{argument}: cannot write '{path}': {cause}") from cause
    return path

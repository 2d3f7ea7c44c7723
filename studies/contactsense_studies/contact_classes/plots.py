"""The picture."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from contactsense._pictures import GREY

from ..harness import Pictures
from .judge import KINDS, probabilities
from .score import score
from .study import Study

_BLUE, _ORANGE = "#0072B2", "#E69F00"


def draw(figure: Figure, study: Study) -> None:
    """Confusion, reliability, and the probabilities themselves."""
    figure.suptitle(
        "Contacts told apart on arms that the weights were not found on", x=0.01, ha="left", weight="bold"
    )
    axes: Any = figure.subplots(1, 3)
    found = score(study.judged)
    _confusion(axes[0], np.array(found.confusion))
    axes[1].plot([0, 1], [0, 1], color=GREY, lw=1)
    for name, bins, colour in (("intended", found.bins, _BLUE), ("likeliest kind", found.kind_bins, _ORANGE)):
        said, came = [each.probability for each in bins], [each.right for each in bins]
        axes[1].errorbar(said, came, [each.chance for each in bins], fmt="o-", color=colour, label=name, ms=4)
    axes[1].set(xlabel="probability", ylabel="share that is right", xlim=(0, 1), ylim=(-0.03, 1.03))
    axes[1].set_title("Reliability")
    axes[1].legend(frameon=False)
    _, _, intended, wanted = probabilities(study.judged)
    edges = np.linspace(0.0, 1.0, 21)
    axes[2].hist([intended[wanted], intended[~wanted]], edges, stacked=True, color=[_BLUE, _ORANGE])
    axes[2].legend(["intended", "accidental"], frameon=False)
    axes[2].set(xlabel="probability that it is intended", ylabel="contacts", title="Intention")


def _confusion(axes: Any, counts: np.ndarray) -> None:
    axes.imshow(counts / np.maximum(counts.sum(axis=1, keepdims=True), 1), cmap="Blues", vmin=0.0, vmax=1.0)
    for (row, column), count in np.ndenumerate(counts):
        axes.text(
            column, row, str(count), ha="center", va="center", color="black" if row != column else "white"
        )
    axes.set_xticks(range(3), KINDS)
    axes.set_yticks(range(3), KINDS)
    axes.set(xlabel="said", ylabel="true", title="Kind")


PICTURES: Pictures = {"contact_classes.png": ((13.0, 4.6), draw)}

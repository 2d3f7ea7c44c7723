"""The pictures."""

from __future__ import annotations

from typing import Any

from matplotlib.figure import Figure

from ..harness import Pictures
from .plot_localization import draw_localization
from .plot_rates import draw_between, draw_delays, draw_detection, draw_false_onsets, draw_time_in_contact
from .plot_stretch import draw_stretches
from .study import Study

_PANELS = (draw_detection, draw_false_onsets, draw_between, draw_time_in_contact, draw_delays)
_ABOUT = (
    "Each arm has torque noise and bias, friction, hysteresis, wrong masses, encoder steps and a velocity "
    "filter. Three monitors get the same measurements."
)


def draw(figure: Figure, study: Study) -> None:
    """All arms in short, and some seconds of the first and the last."""
    parts: Any = figure.subfigures(2, 1, height_ratios=(1.0, 1.55), hspace=0.02)
    rates, stretches = parts
    title = "Contacts on simulated arms with the errors of real ones, before and after calibration"
    rates.suptitle(title, fontsize=15, weight="bold", x=0.01, ha="left")
    axes: Any = rates.subplots(1, len(_PANELS))
    for each, draw_panel in zip(axes, _PANELS, strict=True):
        draw_panel(each, study)
    handles, labels = axes[0].get_legend_handles_labels()
    rates.legend(
        handles,
        labels,
        loc="outside lower center",
        ncols=len(labels),
        frameon=False,
        fontsize=11,
        title=_ABOUT,
        title_fontsize=10,
    )
    shown = [trial for trial in study.trials if trial.stretch is not None]
    draw_stretches(stretches, shown[:1] if len(shown) < 2 else [shown[0], shown[-1]])


PICTURES: Pictures = {
    "real_arm.png": ((19.0, 12.5), draw),
    "real_arm_localization.png": ((16.0, 9.5), draw_localization),
}

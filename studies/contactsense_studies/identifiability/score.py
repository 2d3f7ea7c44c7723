"""What of it is counted, by link."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .study import Pose

NEAR = 0.05  # [m]; the default of `locate_within`
ALL = "all"


@dataclass(frozen=True)
class LinkScore:
    """Contacts at the samples of one link in all poses."""

    link: str
    samples: int  # of one pose
    point_std: float  # median [m]
    point_std_90: float  # 90th percentile [m]
    near: float  # share with a standard deviation of at most `NEAR`
    rank: int  # the most frequent
    detectable: float  # share


def links(poses: Sequence[Pose]) -> list[LinkScore]:
    """Each link, in the robot's order, and all samples together."""
    names = np.array(poses[0].told.links)
    scores = [_score(link, poses, names == link) for link in dict.fromkeys(poses[0].told.links)]
    return [*scores, _score(ALL, poses, np.ones(len(names), dtype=bool))]


def _score(link: str, poses: Sequence[Pose], own: np.ndarray) -> LinkScore:
    told = [pose.told for pose in poses]
    deviations = np.concatenate([each.point_std[own] for each in told])
    ranks = np.concatenate([each.rank[own] for each in told])
    median, high = np.percentile(deviations, (50.0, 90.0))
    return LinkScore(
        link=link,
        samples=int(own.sum()),
        point_std=float(median),
        point_std_90=float(high),
        near=float(np.mean(deviations <= NEAR)),
        rank=int(np.bincount(ranks).argmax()),
        detectable=float(np.mean(np.concatenate([each.detectable[own] for each in told]))),
    )

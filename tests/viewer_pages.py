"""Pages in a browser: what their pixels tell, and what tests of them share."""

from __future__ import annotations

import io
import socket

import numpy as np
from tools.browser import Browser

# Seconds from the start of the log `pushed`: before the push, and in the middle of it.
BEFORE, PUSHED = 0.4, 1.1


def free_port() -> int:
    with socket.socket() as it:
        it.bind(("127.0.0.1", 0))
        return int(it.getsockname()[1])


def pixels(browser: Browser) -> np.ndarray:
    """The scene: left of the controls, below what viser tells."""
    from matplotlib.image import imread

    picture: np.ndarray = imread(io.BytesIO(browser.picture()), format="png")[160:, :580, :3]
    return picture


def blue(browser: Browser) -> int:
    """Pixels of links that are touched."""
    scene = pixels(browser)
    return int(np.count_nonzero(scene[..., 2] - scene[..., 0] > 0.3))


def yellow(browser: Browser) -> int:
    """Pixels of forces."""
    scene = pixels(browser)
    return int(np.count_nonzero(scene[..., 2] - scene[..., 0] < -0.3))


def purple(browser: Browser) -> int:
    """Pixels of particles."""
    scene = pixels(browser)
    return int(np.count_nonzero(np.minimum(scene[..., 0], scene[..., 2]) - scene[..., 1] > 0.2))


def green(browser: Browser) -> int:
    """Pixels of sensors and what they measure."""
    scene = pixels(browser)
    return int(np.count_nonzero(scene[..., 1] - scene[..., 0] > 0.2))

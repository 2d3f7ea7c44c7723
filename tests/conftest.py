"""Settings of all tests: repeatable examples, and a reason where data from outside the project are absent."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from hypothesis import settings
from robots import SHARED, shared_is_there
from tools.browser import Browser, chromium

# The same examples in every run; `--hypothesis-profile=explore` draws others and tells how to repeat them.
settings.register_profile("repeatable", derandomize=True, deadline=None)
settings.register_profile("explore", deadline=None, print_blob=True)
settings.load_profile("repeatable")


def pytest_runtest_setup(item: pytest.Item) -> None:
    if item.get_closest_marker("shared") and not shared_is_there():
        pytest.skip(f"needs robots or logs that are not part of the project, in {SHARED}")


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """One tab for the tests of a file: it draws while it is there, without a graphics card, in threads."""
    if chromium() is None:
        pytest.skip("there is no Chromium")
    pytest.importorskip("matplotlib")
    pytest.importorskip("websockets")
    with Browser(1000, 600) as browser:
        yield browser

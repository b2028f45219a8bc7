"""One browser for all tests of a file; a page may neither complain nor ask anybody."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from chromium import Browser, chromium


@pytest.fixture(scope="module")
def session() -> Iterator[Browser]:
    with chromium() as browser:
        yield browser


@pytest.fixture
def browser(session: Browser) -> Iterator[Browser]:
    session.screen(1280, 900, "light")
    session.complaints()
    session.outside_requests()
    yield session
    assert session.complaints() == []
    assert session.outside_requests() == []

"""DDS domains that no other test, worker or run of the tests on this machine is likely to use."""

from __future__ import annotations

import os
import zlib

WORKERS, TESTS = 4, 25
"""At most, so that none share a domain; there are a hundred."""


def domain_of(number: int) -> int:
    """The domain of a test, by a number that is its own."""
    assert 0 <= number < TESTS
    run = os.environ.get("PYTEST_XDIST_TESTRUNUID", str(os.getpid()))
    worker = int(os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw")) % WORKERS
    return 1 + (zlib.crc32(run.encode()) + TESTS * worker + number) % (WORKERS * TESTS)

"""Hypothesis without deadlines: a shared machine may be slow, and the first call compiles.

In CI the same examples are tried every time, so that a change is judged by what it changes.
"""

import os

from hypothesis import settings

settings.register_profile("toponav", deadline=None, derandomize="CI" in os.environ)
settings.load_profile("toponav")


def pytest_terminal_summary(terminalreporter) -> None:
    """Print the figures that tests measured: `record_property("figures", line)`."""
    lines = [
        line
        for report in terminalreporter.stats.get("passed", [])
        for name, line in report.user_properties
        if name == "figures"
    ]
    if lines:
        terminalreporter.section("measured")
    for line in lines:
        terminalreporter.write_line(line)

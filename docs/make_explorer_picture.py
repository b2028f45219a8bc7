"""Draws docs/images/explorer.png: one decision as the explorer shows it.

Needs Debian's chromium and chromium-driver, and the extra `dev`.
"""

from __future__ import annotations

import io
import shutil
import tempfile
from pathlib import Path

from PIL import Image
from selenium import webdriver
from selenium.webdriver.support.ui import WebDriverWait

from toponav.cli.main import main

IMAGES = Path(__file__).parent / "images"
WHERE = "#scene=generated_0&index=0&decision=4"
WIDTH, HEIGHT = 1280, 860
COLORS = 200
"""Of the palette: a third of the bytes, and nothing is seen of it."""


def draw() -> None:
    """Run two episodes, write their page, and take a picture of one decision."""
    with tempfile.TemporaryDirectory() as name:
        run = Path(name) / "run"
        for command in (
            ["eval", "generated:0", "--episodes", "2", "--out", str(run)],
            ["report", str(run)],
        ):
            if main(command) != 0:
                raise SystemExit("the command failed; its message is above")
        image = Image.open(io.BytesIO(picture_of(run / "report.html")))
    IMAGES.mkdir(exist_ok=True)
    palette = image.convert("RGB").quantize(COLORS, Image.Quantize.MAXCOVERAGE, kmeans=1)
    palette.save(IMAGES / "explorer.png", optimize=True)


def picture_of(page: Path) -> bytes:
    """A PNG of the page, opened at the decision."""
    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium") or "chromium"
    for argument in ("--headless=new", "--no-sandbox", "--hide-scrollbars"):
        options.add_argument(argument)
    service = webdriver.ChromeService(executable_path=shutil.which("chromedriver"))
    driver = webdriver.Chrome(options=options, service=service)
    try:
        size = {"width": WIDTH, "height": HEIGHT, "deviceScaleFactor": 1, "mobile": False}
        driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
        driver.get(page.as_uri() + WHERE)
        shown = "return document.querySelectorAll('.facts canvas').length > 0"
        WebDriverWait(driver, 20).until(lambda d: d.execute_script(shown))
        return bytes(driver.get_screenshot_as_png())
    finally:
        driver.quit()


if __name__ == "__main__":
    draw()

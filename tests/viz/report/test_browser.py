"""The explorer in a real browser, on a real run of twenty episodes."""

from __future__ import annotations

import io
import json
from pathlib import Path
from urllib.parse import urlencode

import numpy as np
import pytest
from chromium import Browser
from explained_runs import explained_run, report_of
from PIL import Image

from toponav.evaluation.recorder import episode_folder
from toponav.evaluation.tables.failures import outcome_of
from toponav.evaluation.tables.runs import Run

Page = tuple[Path, list[Run]]
SOURCE, EPISODES = "generated:6-9", 20
RIGHT, LEFT, END = "\ue014", "\ue012", "\ue010"


EACH = "return [...document.querySelectorAll('{}')].map((one) => {})"


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Page:
    folder = tmp_path_factory.mktemp("explorer")
    first = explained_run(folder / "default", SOURCE, EPISODES)
    second = explained_run(folder / "paper", SOURCE, 4, preset="paper")
    return report_of(folder / "report.html", first, second)


def address(run: Run, k: int, **more: str) -> str:
    result = run.episodes[k]
    return "#" + urlencode({"run": run.name, "scene": result.scene, "index": result.index, **more})


def decision_steps(run: Run, k: int) -> list[int]:
    result = run.episodes[k]
    folder = episode_folder(run.folder, result.scene, result.index)
    lines = (folder / "decisions.jsonl").read_text().splitlines()
    return [json.loads(line)["step"] for line in lines]


def longest(run: Run) -> int:
    return max(range(len(run.episodes)), key=lambda k: run.episodes[k].decisions)


def open_episode(browser: Browser, page: Page, k: int, **more: str) -> None:
    path, runs = page
    browser.open(path, address(runs[0], k, **more))
    browser.until("return document.querySelector('.facts')?.children.length > 0")


def shown_step(browser: Browser, step: int) -> None:
    text = f"at step {step},"
    browser.until(
        "return document.querySelector('.caption').innerText.includes(arguments[0])", text
    )


def test_a_console_error_and_a_request_are_noticed(session: Browser, tmp_path: Path) -> None:
    bad = tmp_path / "bad.html"
    bad.write_text("<img src='http://127.0.0.1:9/x.png'><script>console.error('oh')</script>")
    session.open(bad)
    session.until("return document.readyState === 'complete'")
    assert any("oh" in line for line in session.complaints())
    assert session.outside_requests() == ["http://127.0.0.1:9/x.png"]


def test_the_results_and_every_episode_are_there(browser: Browser, page: Page) -> None:
    path, runs = page
    browser.open(path)
    assert browser.count("#list a") == EPISODES
    assert browser.text(".results h2") == "Runs"
    table = browser.text(".results table")
    assert all(run.name in table for run in runs)
    found = sum(result.succeeded for result in runs[0].episodes)
    assert f"{100 * found / EPISODES:.1f}" in table
    assert f"SR {100 * found / EPISODES:.1f} %" in browser.text("#count")


def test_filters_leave_what_they_name(browser: Browser, page: Page) -> None:
    path, runs = page
    browser.open(path)
    episodes = runs[0].episodes

    def listed(name: str, value: str) -> int:
        browser.choose(name, value)
        count = browser.count("#list a")
        browser.choose(name, "")
        return count

    target = episodes[0].target.replace("_", " ")
    assert listed("category", target) == sum(e.target == episodes[0].target for e in episodes)
    assert listed("scene", episodes[0].scene) == sum(e.scene == episodes[0].scene for e in episodes)
    assert listed("result", "found") == sum(e.succeeded for e in episodes)
    assert listed("result", "not found") == sum(not e.succeeded for e in episodes)
    assert listed("text", f"{episodes[3].scene} #{episodes[3].index}") == 1
    assert listed("text", "no such thing") == 0
    for failure in {outcome_of(e) for e in episodes if not e.succeeded}:
        assert listed("failure", failure) == sum(outcome_of(e) == failure for e in episodes)
    browser.choose("run", "1")
    assert browser.count("#list a") == len(runs[1].episodes)
    elsewhere = {e.key: e.succeeded for e in runs[0].episodes}
    apart = sum(elsewhere[e.key] != e.succeeded for e in runs[1].episodes)
    assert listed("result", "runs disagree") == apart


def test_the_arrows_step_through_the_decisions_as_they_were_made(
    browser: Browser, page: Page
) -> None:
    k = longest(page[1][0])
    steps = decision_steps(page[1][0], k)
    assert len(steps) > 2
    open_episode(browser, page, k)
    walked = []
    for number, step in enumerate(steps, start=1):
        shown_step(browser, step)
        assert f"decision={number}" in browser.run("return location.hash")
        points = "return document.querySelector('.walked')?.points.numberOfItems ?? 0"
        walked.append(browser.run(points))
        browser.press(RIGHT)
    assert walked == [step + 1 for step in steps]
    browser.until("return document.querySelector('.caption').innerText.startsWith('The end')")
    browser.press(LEFT)
    shown_step(browser, steps[-1])
    browser.press(END)
    browser.until("return location.hash.includes('decision=end')")


def test_decisions_at_one_step_are_each_shown(browser: Browser, page: Page) -> None:
    run = page[1][0]
    steps = [decision_steps(run, k) for k in range(len(run.episodes))]
    k = next(k for k, own in enumerate(steps) if len(set(own)) < len(own))
    again = next(n for n, step in enumerate(steps[k]) if step in steps[k][:n])
    for number in (again, again + 1):
        open_episode(browser, page, k, decision=str(number))
        browser.until(
            "return document.querySelector('.caption').innerText.startsWith(arguments[0])",
            f"Decision {number} at step {steps[k][again]},",
        )
    assert browser.count(".ticks span") == len(steps[k]) + 1


def test_a_deep_link_opens_its_decision(browser: Browser, page: Page) -> None:
    run = page[1][0]
    k = longest(run)
    open_episode(browser, page, k, decision="2")
    shown_step(browser, decision_steps(run, k)[1])
    assert run.episodes[k].target.replace("_", " ") in browser.text(".episode h1")
    assert f"{run.episodes[k].scene} #{run.episodes[k].index}" in browser.text(".episode h1")
    assert browser.text("#list [aria-current] b") == run.episodes[k].target.replace("_", " ")
    open_episode(browser, page, k, decision="1")
    assert browser.count(".views canvas") == 12
    assert browser.count(".views .chosen") == 1
    browser.open(page[0], "#run=nobody&scene=nowhere&index=7")
    assert "no such episode" in browser.text(".empty")


def test_the_map_shows_what_the_decision_knew(browser: Browser, page: Page) -> None:
    open_episode(browser, page, longest(page[1][0]), decision="2")
    assert browser.count(".map .raster image") >= 4
    assert browser.count(".map .node") >= 1
    assert browser.count(".map .frontier") >= 1
    assert browser.count(".small tbody tr") == browser.count(".map .frontier")
    browser.run("document.querySelector('.layer.places input').click()")
    assert browser.count(".map .node") == 0
    browser.run("document.querySelector('.layer.places input').click()")
    assert browser.count(".map .node") >= 1
    known = "document.querySelector('.raster image').href.baseVal"
    before = browser.run(f"return {known}")
    browser.press(RIGHT)
    browser.until(f"return {known} !== arguments[0]", before)


def test_two_runs_stand_side_by_side_on_one_episode(browser: Browser, page: Page) -> None:
    _, runs = page
    common = runs[1].episodes[0].key
    k = [result.key for result in runs[0].episodes].index(common)
    open_episode(browser, page, k, **{"with": runs[1].name})
    browser.until("return document.querySelectorAll('.pane .facts .fact').length > 2")
    titles = browser.run(EACH.format(".pane h2", "one.innerText.split(' ')[0].trim()"))
    assert titles == [run.name for run in runs]
    views = EACH.format(".pane .map", "one.getAttribute('viewBox')")
    assert len(set(browser.run(views))) == 1
    browser.press("c")
    browser.until("return document.querySelectorAll('.pane').length === 1")
    assert "with=" not in browser.run("return location.hash")


def test_the_keys(browser: Browser, page: Page) -> None:
    browser.open(page[0])
    browser.press("j")
    browser.until("return document.querySelector('[aria-current]')?.dataset.k === '0'")
    browser.press("j")
    browser.until("return document.querySelector('[aria-current]')?.dataset.k === '1'")
    browser.press("k")
    browser.until("return document.querySelector('[aria-current]')?.dataset.k === '0'")
    browser.press("/")
    browser.press("j")
    assert browser.run("return document.getElementById('filters').elements.text.value") == "j"
    browser.press("\ue00c")
    browser.press("?")
    assert browser.run("return document.getElementById('keys').open")
    browser.press("\ue00c")
    browser.press("r")
    browser.until("return document.body.dataset.view === 'results'")


@pytest.mark.parametrize("width", [1280, 390])
def test_both_widths_and_themes(browser: Browser, page: Page, width: int, tmp_path: Path) -> None:
    brightness = {}
    for theme in ("light", "dark"):
        browser.screen(width, 844, theme)
        for name, where in (
            ("results", "#view=results"),
            ("episode", address(page[1][0], longest(page[1][0]), decision="2")),
        ):
            browser.open(page[0], where)
            browser.until("return document.querySelector('.facts, .results table') !== null")
            assert browser.run("return document.documentElement.scrollWidth <= innerWidth")
            png = browser.driver.get_screenshot_as_png()
            (tmp_path / f"{name}_{width}_{theme}.png").write_bytes(png)
            image = np.asarray(Image.open(io.BytesIO(png)).convert("L"))
            assert image.shape[1] == width
            brightness[name, theme] = image.mean()
    for name in ("results", "episode"):
        assert brightness[name, "light"] > 170.0
        assert brightness[name, "dark"] < 85.0


def test_the_theme_can_be_chosen(browser: Browser, page: Page) -> None:
    browser.open(page[0])
    background = "return getComputedStyle(document.body).backgroundColor"
    light = browser.run(background)
    browser.press("t")
    assert browser.run(background) == light
    browser.press("t")
    assert browser.run(background) != light
    browser.press("t")
    assert browser.run(background) == light

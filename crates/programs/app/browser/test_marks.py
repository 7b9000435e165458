"""Stretches of recordings: marked by a drag, changed by number, kept in the bench file."""

from __future__ import annotations

import tomllib

from playwright.sync_api import Page, expect

from conftest import App


def look(page: Page) -> None:
    page.get_by_role("link", name="Look at recordings").click()
    expect(page.locator("canvas")).to_be_visible()
    page.wait_for_timeout(500)


def drag(page: Page) -> None:
    box = page.locator("canvas").bounding_box()
    page.mouse.move(box["x"] + 300, box["y"] + 60)
    page.mouse.down()
    page.mouse.move(box["x"] + 400, box["y"] + 60, steps=4)
    page.mouse.up()


def saved(page: Page, app: App) -> list[dict]:
    page.locator(".marks").get_by_role("button", name="Save").click()
    expect(page.locator(".marks").get_by_text("saved", exact=True)).to_be_visible()
    return tomllib.loads((app.folder / "bench.toml").read_text(encoding="utf-8"))["recordings"].get("stretch", [])


def test_a_drag_marks_a_stretch_that_is_changed_by_number(page: Page, app: App) -> None:
    look(page)
    page.locator("canvas").focus()
    page.keyboard.press("m")
    address = page.url
    drag(page)
    expect(page.locator(".marks li")).to_have_count(1)
    page.wait_for_timeout(400)
    # A drag marks, and does not move the plot.
    assert page.url == address
    (stretch,) = saved(page, app)
    assert stretch["leave_out"][0] < stretch["leave_out"][1] and stretch["file"].endswith(".mf4")
    page.get_by_label("Beginning of stretch 1, s").fill("1.5")
    page.get_by_label("Beginning of stretch 1, s").press("Tab")
    page.wait_for_timeout(600)
    page.get_by_label("Use of stretch 1").select_option("estimate")
    page.wait_for_timeout(600)
    (changed,) = saved(page, app)
    assert changed == {"file": stretch["file"], "estimate": [1.5, stretch["leave_out"][1]]}
    page.get_by_role("button", name="Delete stretch 1").click()
    expect(page.locator(".marks li")).to_have_count(0)
    assert saved(page, app) == []


def test_the_cursors_mark_without_a_mouse_and_faults_are_shown(page: Page) -> None:
    look(page)
    canvas = page.locator("canvas")
    canvas.focus()
    for key in ["m", "+", "ArrowRight", "a", "ArrowRight", "ArrowRight", "b"]:
        page.keyboard.press(key)
    page.get_by_role("button", name="Mark from A to B").click()
    expect(page.locator(".marks li")).to_have_count(1)
    page.get_by_label("End of stretch 1, s").fill("-5")
    page.get_by_label("End of stretch 1, s").press("Tab")
    expect(page.locator(".marks .fault")).to_contain_text("recordings.stretch.leave_out")
    page.locator(".marks").get_by_role("button", name="Undo").click()
    expect(page.locator(".marks .fault")).to_have_count(0)

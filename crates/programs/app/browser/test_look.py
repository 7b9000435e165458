"""Recordings: shown, zoomed, measured; the address has it all."""

from __future__ import annotations

from playwright.sync_api import Page, expect


def look(page: Page) -> None:
    page.get_by_role("link", name="Look at recordings").click()
    page.wait_for_selector("canvas")
    expect(page.locator(".channel input:checked")).to_have_count(3)


def test_two_clicks_from_the_start_show_a_stretch_with_figures(page: Page) -> None:
    look(page)
    box = page.locator("canvas").bounding_box()
    page.mouse.click(box["x"] + 300, box["y"] + 60)
    expect(page.locator(".figures caption")).to_contain_text("A at")
    page.mouse.click(box["x"] + 600, box["y"] + 60)
    expect(page.locator(".figures caption")).to_contain_text("Δt")
    expect(page.locator(".figures tbody tr").first.locator("td")).to_have_count(10)


def test_a_reload_shows_the_same(page: Page) -> None:
    look(page)
    box = page.locator("canvas").bounding_box()
    page.mouse.click(box["x"] + 300, box["y"] + 60)
    page.mouse.click(box["x"] + 600, box["y"] + 60)
    page.get_by_role("button", name="Zoom to the cursors").click()
    page.locator("label.channel", has=page.locator("input:not(:checked)")).first.click()
    expect(page.locator(".figures tbody tr")).to_have_count(4)
    page.wait_for_timeout(400)
    address, caption = page.url, page.locator(".figures caption").inner_text()
    page.reload()
    expect(page.locator(".figures caption")).to_have_text(caption)
    expect(page.locator(".figures tbody tr")).to_have_count(4)
    assert page.url == address


def test_keys_alone_zoom_and_set_cursors(page: Page) -> None:
    look(page)
    canvas = page.locator("canvas")
    canvas.focus()
    for key in ["+", "ArrowRight", "a", "ArrowRight", "b"]:
        page.keyboard.press(key)
    expect(page.locator(".figures caption")).to_contain_text("Δt")
    page.keyboard.press("Home")
    page.wait_for_timeout(300)


def test_channels_are_found_by_a_part_of_their_name(page: Page) -> None:
    look(page)
    every = page.locator(".channel").count()
    page.get_by_label("Find a channel").fill("speed")
    assert 0 < page.locator(".channel").count() < every


def test_two_recordings_lie_over_one_another(page: Page) -> None:
    look(page)
    page.get_by_label("lay the next one over it").check()
    recordings = page.get_by_label("Recording", exact=True)
    recordings.select_option(index=1)
    expect(page.locator(".channel input:checked")).to_have_count(3)
    expect(page.locator(".line-of")).to_have_count(6)
    # The same channels, in the same plots.
    expect(page.locator(".line-of input").nth(6)).to_have_value("1")
    offset = page.locator(".line-of input").nth(7)
    offset.fill("2.5")
    offset.press("Tab")
    page.wait_for_timeout(400)
    page.reload()
    expect(page.locator(".line-of input").nth(7)).to_have_value("2.5")
    expect(page.locator(".line-of input").nth(6)).to_have_value("1")

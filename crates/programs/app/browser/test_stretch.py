"""Analyses of the stretch that is seen or between the cursors, and files of it."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Page, expect

from conftest import App


def look(page: Page) -> None:
    page.get_by_role("link", name="Look at recordings").click()
    expect(page.locator(".channel input:checked")).to_have_count(3)


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("Histogram", "bins of"),
        ("Spectrum", "segments averaged"),
        ("Spectrogram", "colours are power density"),
        ("XY", "pairs"),
    ],
)
def test_an_analysis_is_drawn_read_and_kept_in_the_address(page: Page, kind: str, words: str) -> None:
    look(page)
    page.get_by_label("Analysis", exact=True).select_option(kind)
    said = page.locator(".stretch [role=status]").last
    expect(said).to_contain_text("What is seen")
    expect(said).to_contain_text(words)
    canvas = page.locator(".curve canvas")
    canvas.hover(position={"x": 400, "y": 150})
    expect(page.locator(".readout")).to_have_text(re.compile(r"\d"))
    before = page.locator(".readout").inner_text()
    canvas.focus()
    page.keyboard.press("Shift+ArrowRight")
    expect(page.locator(".readout")).not_to_have_text(before)
    page.wait_for_timeout(300)
    page.reload()
    expect(page.locator(".stretch [role=status]").last).to_contain_text(words)


@pytest.mark.refused("422")
def test_cursors_choose_the_stretch(page: Page) -> None:
    look(page)
    page.get_by_label("Analysis", exact=True).select_option("Spectrum")
    box = page.locator(".plots canvas").bounding_box()
    page.mouse.click(box["x"] + 300, box["y"] + 60)
    page.mouse.click(box["x"] + 600, box["y"] + 60)
    expect(page.locator(".stretch [role=status]").last).to_contain_text("Between the cursors")
    expect(page.locator(".stretch code")).to_contain_text("dynoid data spectrum")
    page.get_by_label("Samples in a segment").select_option("65536")
    expect(page.locator(".stretch .fault")).to_contain_text("shorter segments")


def test_plots_and_stretches_are_saved(page: Page, app: App) -> None:
    look(page)
    with page.expect_download() as download:
        page.get_by_role("button", name="Save the plots as a picture").click()
    assert download.value.path().read_bytes().startswith(b"\x89PNG")
    for ending in ["csv", "parquet", "mf4"]:
        page.get_by_label("Format").select_option(ending)
        page.get_by_role("button", name="Save", exact=True).click()
        expect(page.locator("#notice")).to_contain_text(f".{ending} is written")
        assert list(app.folder.rglob(f"*_s.{ending}"))

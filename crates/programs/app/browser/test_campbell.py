"""The Campbell map: a line has its cause, and its alias at another sample rate."""

from __future__ import annotations

from playwright.sync_api import Page, expect

from conftest import App


def test_a_line_has_a_cause_and_an_alias(page: Page, app: App) -> None:
    page.goto(app.at("campbell"))
    expect(page.get_by_label("Recording")).to_have_value("recordings/Ramp_N_NT_1200.mf4")
    expect(page.locator(".campbell h2")).to_have_text("order 2, firing", timeout=120_000)
    page.get_by_label("Another sample rate, Hz").fill("60")
    # Order 2 at 1200 rpm is 40 Hz, which shows at 20 Hz.
    row = page.locator("tr", has_text="Shows at 60")
    expect(row).to_contain_text("Hz")
    assert abs(float(row.locator("td").nth(1).inner_text().split()[0]) - 20) < 0.5
    page.locator(".map canvas").focus()
    page.keyboard.press("ArrowDown")
    expect(page.locator(".campbell h2")).not_to_have_text("order 2, firing")

"""The study: run, followed, cancelled, found again after a reload."""

from __future__ import annotations

from playwright.sync_api import Page, expect

from conftest import App


def test_a_study_is_run_and_its_report_is_shown(page: Page, app: App) -> None:
    (app.folder / "study" / "report.html").unlink(missing_ok=True)
    page.get_by_role("link", name="Study the bench").click()
    page.get_by_role("button", name="Study").click()
    expect(page.locator("progress").first).to_be_visible(timeout=20_000)
    expect(page.locator("iframe.page")).to_be_visible(timeout=180_000)
    frame = page.frame_locator("iframe.page")
    expect(frame.locator("h1").first).to_be_visible()


def test_a_finding_leads_to_its_recording(page: Page) -> None:
    page.get_by_role("link", name="Study the bench").click()
    page.locator(".result summary").click()
    rows = page.locator(".result tbody tr")
    expect(rows).not_to_have_count(0)
    page.locator(".result tbody a").first.click()
    expect(page.locator(".plots canvas")).to_be_visible()
    assert "#/look?file=" in page.url


def test_a_study_goes_on_while_the_page_is_loaded_again_and_is_cancelled(page: Page) -> None:
    page.get_by_role("link", name="Study the bench").click()
    page.get_by_role("button", name="Study").click()
    expect(page.get_by_role("button", name="Cancel")).to_be_visible(timeout=20_000)
    page.reload()
    page.get_by_role("button", name="Cancel").click(timeout=20_000)
    expect(page.locator("#notice")).to_contain_text("cancelled", timeout=20_000)
    page.locator("#work").click()
    expect(page.locator(".job").first).to_contain_text("cancelled")
    expect(page.locator(".job code").first).to_contain_text("dynoid study bench.toml")

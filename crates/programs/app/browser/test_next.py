"""What to record next: gain beside safety, an experiment with other numbers, and its demands."""

from __future__ import annotations

from playwright.sync_api import Page, expect

from conftest import App

LONG = 300_000


def test_gain_and_safety_of_the_method_and_of_ones_own(app: App, page: Page) -> None:
    page.goto(app.at("next?speed=1500&duration=8"))
    page.get_by_role("button", name="Look for experiments").click()
    expect(page.locator(".progress")).to_contain_text("calculating")
    rows = page.locator(".verdict tbody tr")
    expect(rows).not_to_have_count(0, timeout=LONG)
    method = rows.count()
    assert method >= 7
    expect(page.locator(".line code").first).to_contain_text("dynoid experiment next bench.toml --speed 1500 --duration 8")
    page.get_by_role("button", name="WhiteNoise_T_TN", exact=True).click()
    deviation = page.get_by_label("deviation in Nm")
    deviation.fill("6")
    deviation.press("Tab")
    page.get_by_role("button", name="Gain and safety with these").click()
    expect(rows).to_have_count(method + 1, timeout=LONG)
    expect(rows.last).to_contain_text("WhiteNoise_T_TN, yours")
    # One's own is checked, whatever it gains.
    expect(rows.last).to_contain_text("reach none")
    page.get_by_role("button", name="Write its demands").click()
    expect(page.locator(".files li")).not_to_have_count(0, timeout=LONG)
    with page.expect_download() as found:
        page.get_by_role("button", name="Download").click()
    assert found.value.path().read_text(encoding="utf-8").count("\n") > 1000
    assert list((app.folder / "experiments").glob("WhiteNoise_T_TN_*.csv"))

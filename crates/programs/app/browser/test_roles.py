"""Channels and roles: swapped by one act, with their traces, saved into the bench file."""

from __future__ import annotations

from playwright.sync_api import Page, expect

from conftest import App


def roles(page: Page) -> None:
    page.locator("#tasks").get_by_role("link", name="Channels").click()
    expect(page.locator(".roles tbody tr")).to_have_count(9)


def test_two_roles_swap_their_channels(page: Page, app: App) -> None:
    roles(page)
    page.get_by_label("N_d", exact=True).select_option("EngineSpeed")
    expect(page.get_by_label("N_e", exact=True)).to_have_value("DynoSpeed")
    page.get_by_role("button", name="Save").click()
    expect(page.get_by_text("saved", exact=True)).to_be_visible()
    text = (app.folder / "bench.toml").read_text(encoding="utf-8")
    assert 'dyno_speed = "EngineSpeed"' in text and 'engine_speed = "DynoSpeed"' in text


def test_unit_and_sign_are_written_beside_the_name(page: Page, app: App) -> None:
    roles(page)
    page.get_by_label("Opposite sign of computed air-gap torque").check()
    expect(page.get_by_label("Opposite sign of computed air-gap torque")).to_be_checked()
    page.get_by_role("button", name="Save").click()
    expect(page.get_by_text("saved", exact=True)).to_be_visible()
    text = (app.folder / "bench.toml").read_text(encoding="utf-8")
    assert 'air_gap_torque = { name = "DynoTorqueCalc", sign = -1 }' in text


def test_a_proposal_gives_its_reasons(page: Page) -> None:
    roles(page)
    page.get_by_role("button", name="Propose roles from the recordings").click()
    expect(page.locator(".why").first).to_contain_text("Proposed", timeout=30_000)

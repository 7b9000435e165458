"""The bench file: saved, kept while it is typed, never overwritten."""

from __future__ import annotations

import pytest
from playwright.sync_api import Page, expect

from conftest import App


def text_of(page: Page):
    page.locator("#tasks").get_by_role("link", name="Bench").click()
    return page.locator("textarea")


def test_a_text_is_saved(page: Page, app: App) -> None:
    text = text_of(page)
    file = app.folder / "bench.toml"
    text.fill("# a remark\n" + file.read_text(encoding="utf-8"))
    page.get_by_role("button", name="Save").click()
    expect(page.get_by_text("saved", exact=True)).to_be_visible()
    assert file.read_text(encoding="utf-8").startswith("# a remark\n")


def test_a_fault_leads_to_its_line(page: Page) -> None:
    text = text_of(page)
    expect(page.get_by_text("The file has no faults.")).to_be_visible()
    text.fill("[bench]\nname = 'Cell 4'\ncylinderz = 4\n")
    page.get_by_role("button", name="Line 3", exact=True).click()
    chosen = page.evaluate(
        "(() => { const text = document.querySelector('textarea');"
        " return text.value.slice(text.selectionStart, text.selectionEnd); })()"
    )
    assert chosen == "cylinderz = 4"


def test_what_was_typed_survives_a_killed_program(page: Page, app: App) -> None:
    text = text_of(page)
    text.fill("# typed, not saved")
    page.wait_for_timeout(900)
    app.kill()
    again = App(app.folder)
    page.goto(again.address)
    expect(text_of(page)).to_have_value("# typed, not saved")
    expect(page.get_by_text("typed earlier, not saved")).to_be_visible()
    again.kill()


@pytest.mark.refused("412")
def test_a_change_of_another_is_noticed(page: Page, app: App) -> None:
    text = text_of(page)
    file = app.folder / "bench.toml"
    expect(text).not_to_have_value("")
    file.write_text("# theirs", encoding="utf-8")
    text.fill("# mine")
    page.get_by_role("button", name="Save").click()
    expect(page.locator("#notice")).to_contain_text("changed elsewhere")
    assert file.read_text(encoding="utf-8") == "# theirs"
    expect(text).to_have_value("# mine")


def test_a_form_changes_its_value_and_nothing_else(page: Page, app: App) -> None:
    text = text_of(page)
    before = text.input_value()
    limit = page.get_by_label("Largest torque of the drive")
    limit.fill("360,5 Nm")
    limit.press("Tab")
    expect(text).to_have_value(before.replace('torque = "400 Nm"', 'torque = "360.5 Nm"'))
    page.get_by_role("button", name="Undo").click()
    expect(text).to_have_value(before)
    page.get_by_role("button", name="Redo").click()
    page.get_by_role("button", name="Save").click()
    expect(page.get_by_text("saved", exact=True)).to_be_visible()
    assert 'torque = "360.5 Nm"' in (app.folder / "bench.toml").read_text(encoding="utf-8")

"""A test on a bench: the answer, and what other limits and another ramp would give."""

from __future__ import annotations

import time

from playwright.sync_api import Page, expect

from conftest import App


def calculated(app: App, page: Page) -> None:
    page.goto(app.at("can?test=tip-in&benches=72"))
    expect(page.locator(".said")).to_be_visible(timeout=180_000)


def test_the_answer_has_its_limits_course_and_basis(app: App, page: Page) -> None:
    calculated(app, page)
    expect(page.locator(".said")).to_contain_text("of 72 benches like yours")
    assert page.locator(".limits .number").count() >= 5
    assert page.locator(".course canvas").get_attribute("aria-label").startswith("Largest ")
    expect(page.locator(".basis")).to_contain_text("72 benches drawn")
    expect(page.locator(".line code")).to_contain_text("dynoid can bench.toml tip-in --model")


def test_another_limit_is_judged_at_once(app: App, page: Page) -> None:
    calculated(app, page)
    field = page.locator("#limit-speed")
    field.fill("100")
    field.press("Tab")
    # Every bench turns faster, at the latest as it begins.
    expect(page.locator(".said")).to_contain_text("No 0 %", timeout=2000)
    expect(page.locator(".stated")).to_contain_text('speed = "100 rpm"')
    expect(page.locator("[data-of=speed] .found")).to_contain_text("too much")
    key = page.evaluate("performance.getEntriesByType('resource').map(({ name }) => name).find((name) => name.includes('/judged'))")
    began = time.perf_counter()
    for _ in range(10):
        assert page.evaluate("(address) => fetch(address).then(({ status }) => status)", key) == 200
    assert time.perf_counter() - began < 0.5, "a judgement takes no run"
    page.get_by_role("button", name="As in the bench file").click()
    expect(page.locator(".stated")).to_be_hidden()


def test_single_benches_are_browsed_and_the_address_has_them(app: App, page: Page) -> None:
    calculated(app, page)
    page.get_by_label("The next bench").click()
    expect(page.locator(".draws")).to_contain_text("Bench 1 of 72")
    page.get_by_label("The next bench").click()
    expect(page.locator(".draws")).to_contain_text("Bench 2 of 72")
    page.reload()
    expect(page.locator(".draws")).to_contain_text("Bench 2 of 72", timeout=5000)


def test_another_ramp_is_a_new_run(app: App, page: Page) -> None:
    calculated(app, page)
    ramp = page.locator("#number-ramp")
    ramp.fill("0.5")
    ramp.press("Tab")
    expect(page.locator(".progress")).to_contain_text("calculating")
    expect(page.locator(".verdict.stale")).to_have_count(1)
    expect(page.locator(".line code")).to_contain_text("--set ramp=0.5")
    expect(page.locator(".verdict.stale")).to_have_count(0, timeout=180_000)


def test_a_question_that_cannot_be_answered_says_why(app: App, page: Page) -> None:
    page.goto(app.at("can?test=whtc&benches=72"))
    expect(page.locator("#notice.fault")).to_contain_text("engine", timeout=10_000)

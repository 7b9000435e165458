"""Long work: other threads go on meanwhile, and Ctrl-C ends it soon."""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import dynoid
import numpy as np
import pytest

pytestmark = pytest.mark.skipif(os.name == "nt", reason="Windows has no such signal")

SOON_S = 0.1
"""Ctrl-C ends any work within this time."""


@pytest.fixture(autouse=True)
def heeded() -> Iterator[None]:
    """Ctrl-C as a terminal has it. A shell starts what runs in the background with it ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def ended_within(work: Callable[[], object], after_s: float) -> float:
    """The time from Ctrl-C to the end of some work, s."""
    pressed: list[float] = []

    def press() -> None:
        time.sleep(after_s)
        pressed.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    # Another thread can press, since the interpreter is not held.
    presser = threading.Thread(target=press)
    presser.start()
    with pytest.raises(KeyboardInterrupt):
        work()
    took = time.monotonic() - pressed[0]
    presser.join()
    return took


def long_data() -> dynoid.Dataset:
    random = np.random.default_rng(1)
    return dynoid.Dataset(random.standard_normal(100_000), random.standard_normal((100_000, 3)), sample_time=1.0)


ESTIMATES: dict[str, Callable[[dynoid.Dataset], object]] = {
    "bj": lambda data: dynoid.fit.bj(data, nb=8, nc=8, nd=8, nf=8),
    "ss": lambda data: dynoid.fit.ss(data, order=8),
    "tf": lambda data: dynoid.fit.tf(data, poles=4, zeros=3),
}


@pytest.mark.parametrize("name", ESTIMATES)
def test_exact_ctrl_c_ends_an_estimate(name: str) -> None:
    data = long_data()
    took = [ended_within(lambda: ESTIMATES[name](data), after_s) for after_s in (0.05, 0.2, 0.4)]
    # The median, since a busy machine may wake a thread late.
    assert sorted(took)[1] < SOON_S, took


def test_exact_ctrl_c_ends_a_study(bench: Path) -> None:
    took = [ended_within(lambda: dynoid.Study.run(bench), after_s) for after_s in (0.05, 0.2, 0.4)]
    assert sorted(took)[1] < SOON_S, took

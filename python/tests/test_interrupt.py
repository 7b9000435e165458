"""Long work: other threads go on meanwhile, and Ctrl-C ends it soon."""

from __future__ import annotations

import os
import signal
import threading
import time

import dynoid
import numpy as np
import pytest


def long_data() -> dynoid.Dataset:
    random = np.random.default_rng(1)
    return dynoid.Dataset(random.standard_normal((200_000, 2)), random.standard_normal((200_000, 3)), sample_time=1.0)


@pytest.mark.skipif(os.name == "nt", reason="Windows has no such signal")
def test_exact_ctrl_c_ends_an_estimate() -> None:
    data = long_data()
    pressed: list[float] = []

    def press() -> None:
        time.sleep(0.5)
        pressed.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    # Another thread can press, since the interpreter is not held.
    threading.Thread(target=press).start()
    with pytest.raises(KeyboardInterrupt):
        dynoid.fit.bj(data, nb=8, nc=8, nd=8, nf=8)
    took = time.monotonic() - pressed[0]
    assert took < 1.0, f"{took:.2f} s"

"""Draws and range of validity of an exported module."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(sys.argv[1])))
import test_cell_4 as model  # noqa: E402

random = np.random.default_rng(5)
drawn = np.array([[b[name] for name in ("K_p", "K_i", "J_d")] for b in (model.Bench().draw(random) for _ in range(4000))])
covariance = np.cov(drawn[:, :2].T)
stated = np.array([row[:2] for row in model.COVARIANCE[1][1][:2]])
assert np.allclose(covariance, stated, rtol=0.12, atol=1.5e-5), covariance
assert (drawn[:, 2] == 0.6).all()
print("draws agree")
response = {"w_d": np.array([79.0, 100.0, 100.0]), "T_d": np.array([0.0, 0.0, 221.0])}
assert model.Bench().is_valid(response).tolist() == [False, True, False]
print("range agrees")
try:
    model.Bench(stiffness=1.0)
except ValueError as error:
    assert "J_d, J_e, K" in str(error)
else:
    raise AssertionError("an unknown parameter is refused")

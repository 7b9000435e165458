"""Linear model. Written by dynoid @VERSION@.

It needs numpy alone.

    import numpy as np
    import @MODULE@ as model

    y = model.simulate(np.ones((1000, len(model.INPUTS))))

@LEVELS@

INPUTS and OUTPUTS are names with units. INPUT_LEVELS and OUTPUT_LEVELS are the levels, None where there is no single one. A, B, C, D are discrete, every SAMPLE_TIME seconds: x(t+1) = A x + B u + K e, y = C x + D u + e.
"""

import numpy as np

# begin of the model
# end of the model


def simulate(u, x0=None):
    """The outputs, one row a sample, on inputs with one row a sample and one column an input; from rest without x0."""
    u = np.asarray(u, dtype=float)
    if u.ndim != 2 or u.shape[1] != len(INPUTS):
        raise ValueError(f"the inputs need one row a sample and {len(INPUTS)} columns, not {u.shape}")
    x = np.zeros(len(A)) if x0 is None else np.array(x0, dtype=float)
    y = np.empty((len(u), len(OUTPUTS)))
    for t, row in enumerate(u):
        y[t] = C @ x + D @ row
        x = A @ x + B @ row
    return y


def control_state_space():
    """The model as a control.StateSpace of the package `control`."""
    import control

    names = {"inputs": [name for name, _ in INPUTS], "outputs": [name for name, _ in OUTPUTS]}
    return control.ss(A, B, C, D, SAMPLE_TIME, **names)

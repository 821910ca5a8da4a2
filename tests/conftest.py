"""Array shapes and types are checked at run time in every test: see `worker/arrays.py`."""

import os

# Before numpy or torch is loaded: one thread, so that results do not depend on the machine.
for variable in ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

from jaxtyping import install_import_hook  # noqa: E402  the threads must be set before

install_import_hook("worker", "beartype.beartype")

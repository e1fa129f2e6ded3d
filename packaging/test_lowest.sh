#!/usr/bin/env bash
# Do the tests pass with the oldest versions that pyproject.toml allows? Of what it names itself; the rest is as new as may
# be. Makes an environment of its own in build/lowest. Arguments go to pytest.
set -euo pipefail
cd "$(dirname "$0")/.."

place=build/lowest
if [ ! -x "$place/bin/pytest" ]; then
    python3 -m venv "$place"
    "$place/bin/python" -m pip install --quiet uv
    "$place/bin/uv" pip compile pyproject.toml --extra dev --extra keyring --resolution lowest-direct --no-header \
        --quiet --output-file "$place/requirements.txt"
    # the libraries Qt needs are brought by whoever runs this, as test.py does
    "$place/bin/python" -m pip install --quiet --no-deps --only-binary :all: --requirement "$place/requirements.txt"
    "$place/bin/python" -m pip install --quiet --no-deps --no-build-isolation --editable .
fi
export QT_QPA_PLATFORM=offscreen PYTHONPYCACHEPREFIX="$PWD/$place/bytecode"
exec "$place/bin/pytest" --numprocesses=2 --max-worker-restart=2 --dist=loadfile "$@"

#!/bin/sh
# Start the page in a container. A Space of a model hub sets SPACE_HOST, and shows it in a frame.
set -eu
if [ -n "${SPACE_HOST:-}" ]; then
    export BOKEH_ALLOW_WS_ORIGIN="${BOKEH_ALLOW_WS_ORIGIN:-$SPACE_HOST}"
    set -- --allow-frame https://huggingface.co "$@"
fi
exec cutcell app --no-show --address 0.0.0.0 --port 7860 "$@"

# The page in a container, see docs/hosting.md:
#   docker build -t cutcell .
#   docker run --rm -p 7860:7860 --read-only --tmpfs /tmp:size=3g cutcell

FROM python:3.13-slim AS build
WORKDIR /source
# Compiled functions run on every processor of the kind, not only on those like the builder's.
ENV NUMBA_CPU_NAME=generic
COPY . .
RUN python -m venv /opt/cutcell
RUN /opt/cutcell/bin/python -m pip install --no-cache-dir --quiet --constraint requirements.lock ".[app,usd]"
RUN /opt/cutcell/bin/python -P -c "from cutcell.weights.warm_up import warm_up; warm_up()"

FROM python:3.13-slim
# OpenGL, to draw pictures without a screen.
RUN apt-get update \
    && apt-get install --yes --no-install-recommends libegl1 libgl1-mesa-dri \
    && rm -rf /var/lib/apt/lists/*
COPY --from=build /opt/cutcell /opt/cutcell
COPY scripts/container.sh /opt/cutcell/container.sh
# Only /tmp is written to.
ENV NUMBA_CPU_NAME=generic HOME=/tmp PATH=/opt/cutcell/bin:/usr/local/bin:/usr/bin:/bin
USER 1000:1000
WORKDIR /tmp
EXPOSE 7860
# A server with all its sessions in use is healthy, too.
HEALTHCHECK --interval=30s --timeout=10s --start-period=60s CMD python -c "from urllib.request import Request, urlopen; urlopen(Request('http://localhost:7860/static/js/bokeh.min.js', method='HEAD'), timeout=9)"
CMD ["sh", "/opt/cutcell/container.sh"]

# The HTTP API: no torch, no geometry, no worker code.
# Build from the repository root: docker build -f docker/service.Dockerfile -t neuralmri-service .
# A release pins the digest: --build-arg PYTHON_IMAGE=python:3.12.13-slim-bookworm@sha256:...
ARG PYTHON_IMAGE=python:3.12.13-slim-bookworm

FROM ${PYTHON_IMAGE} AS build
ENV PIP_NO_CACHE_DIR=1 PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_ROOT_USER_ACTION=ignore
WORKDIR /build
RUN python -m venv --without-pip /opt/neuralmri
# Dependencies in a layer of their own: it is built again only when they change.
# Wheels only: nothing is ever compiled, so no stage needs a compiler.
COPY pyproject.toml constraints.txt README.md LICENSE ./
RUN pip --python /opt/neuralmri/bin/python install --no-cache-dir --only-binary=:all: \
      --constraint constraints.txt ".[service]" ".[s3]"
# What sends spans to an OpenTelemetry collector, for who wants it: --build-arg OTEL=true
ARG OTEL=false
RUN if [ "${OTEL}" = true ]; then \
      pip --python /opt/neuralmri/bin/python install --no-cache-dir --only-binary=:all: \
        --constraint constraints.txt ".[otel]"; \
    fi
COPY schemas schemas
COPY intake intake
COPY jobs jobs
COPY service service
# The command line's package is not in this image, so neither is its script.
RUN pip --python /opt/neuralmri/bin/python install --no-cache-dir --no-deps --force-reinstall . \
    && rm /opt/neuralmri/bin/neuralmri \
    && /opt/neuralmri/bin/python -c "import service.process"

FROM ${PYTHON_IMAGE}
ARG VERSION=0.1.0
ARG REVISION=unknown
LABEL org.opencontainers.image.title="neuralmri service" \
      org.opencontainers.image.description="HTTP API: sparse heart segmentations in, 3D surfaces out" \
      org.opencontainers.image.licenses="Apache-2.0" \
      org.opencontainers.image.version="${VERSION}" \
      org.opencontainers.image.revision="${REVISION}"
# A numeric owner, so that an orchestrator can check that it is not root. A new named volume takes
# the owner of the folder it is mounted on. The base image's installer is of no use at run time.
RUN groupadd --gid 10001 neuralmri \
    && useradd --uid 10001 --gid 10001 --no-create-home --home-dir /tmp \
      --shell /usr/sbin/nologin neuralmri \
    && install -d -o 10001 -g 10001 -m 0750 /var/lib/neuralmri \
    && python -m pip uninstall --yes pip
COPY --from=build /opt/neuralmri /opt/neuralmri
# Nothing here multiplies matrices: numpy need not start a thread for each core.
ENV PATH=/opt/neuralmri/bin:$PATH \
    HOME=/tmp \
    PYTHONDONTWRITEBYTECODE=1 \
    PYTHONUNBUFFERED=1 \
    OPENBLAS_NUM_THREADS=1 \
    NEURALMRI_DATA_DIR=/var/lib/neuralmri \
    NEURALMRI_LOG_FORMAT=json
WORKDIR /opt/neuralmri
USER 10001:10001
EXPOSE 8000
STOPSIGNAL SIGTERM
HEALTHCHECK --interval=15s --timeout=5s --start-period=20s --retries=3 \
  CMD ["python", "-c", "from urllib.request import urlopen; urlopen('http://127.0.0.1:8000/healthz', timeout=4)"]
CMD ["uvicorn", "--factory", "service.process:app_of_process", "--host", "0.0.0.0", "--port", "8000", \
     "--http", "service.header_deadline:HeaderDeadline", \
     "--no-server-header", "--no-access-log", "--timeout-graceful-shutdown", "20"]

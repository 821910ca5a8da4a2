# The Celery worker around the science: torch for CPUs, no HTTP server.
# Build from the repository root: docker build -f docker/worker.Dockerfile -t neuralmri-worker .
# A release pins the digest: --build-arg PYTHON_IMAGE=python:3.12.13-slim-bookworm@sha256:...
ARG PYTHON_IMAGE=python:3.12.13-slim-bookworm

FROM ${PYTHON_IMAGE} AS build
ENV PIP_NO_CACHE_DIR=1 PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_ROOT_USER_ACTION=ignore
WORKDIR /build
RUN python -m venv --without-pip /opt/neuralmri
COPY pyproject.toml constraints.txt README.md LICENSE ./
# torch by itself and first: the general index serves a build with gigabytes of GPU libraries.
# TORCH_INDEX_URL names an index of CPU builds: PyTorch's own, or a mirror of it.
ARG TORCH_INDEX_URL=
RUN : "${TORCH_INDEX_URL:?name an index of CPU builds of torch with --build-arg TORCH_INDEX_URL=...}" \
    && grep '^torch==' constraints.txt > torch.txt \
    && pip --python /opt/neuralmri/bin/python install --no-cache-dir --only-binary=:all: --no-deps \
      --index-url "${TORCH_INDEX_URL}" --requirement torch.txt
# Wheels only: nothing is ever compiled, so no stage needs a compiler.
# libigl's brings modules that nothing here loads and that may not be passed on like the rest: CGAL
# (GPL), tetgen (AGPL) and triangle (not for trade).
RUN pip --python /opt/neuralmri/bin/python install --no-cache-dir --only-binary=:all: \
      --constraint constraints.txt ".[worker]" ".[s3]" \
    && rm -r /opt/neuralmri/lib/python3*/site-packages/igl/copyleft \
      /opt/neuralmri/lib/python3*/site-packages/igl/triangle
# What sends spans to an OpenTelemetry collector, for who wants it: --build-arg OTEL=true
ARG OTEL=false
RUN if [ "${OTEL}" = true ]; then \
      pip --python /opt/neuralmri/bin/python install --no-cache-dir --only-binary=:all: \
        --constraint constraints.txt ".[otel]"; \
    fi
# A GPU build of torch, or a wheel that wants a system library this base lacks, ends the build here.
RUN /opt/neuralmri/bin/python -c "import torch; assert torch.version.cuda is None, 'torch is a GPU build; set TORCH_INDEX_URL to an index of CPU builds'" \
    && /opt/neuralmri/bin/python -c "import fast_simplification, igl, nibabel, scipy, shapely, skimage.measure, trimesh"
COPY schemas schemas
COPY intake intake
COPY jobs jobs
COPY worker worker
# The command line's package is not in this image, so neither is its script.
RUN pip --python /opt/neuralmri/bin/python install --no-cache-dir --no-deps --force-reinstall . \
    && rm /opt/neuralmri/bin/neuralmri \
    && /opt/neuralmri/bin/python -c "import worker.app"

FROM ${PYTHON_IMAGE}
ARG VERSION=0.1.0
ARG REVISION=unknown
LABEL org.opencontainers.image.title="neuralmri worker" \
      org.opencontainers.image.description="Fits a neural field to a heart's slices and extracts its surfaces" \
      org.opencontainers.image.licenses="Apache-2.0" \
      org.opencontainers.image.version="${VERSION}" \
      org.opencontainers.image.revision="${REVISION}"
# The same owner as in the service's image: both write to the job store.
RUN groupadd --gid 10001 neuralmri \
    && useradd --uid 10001 --gid 10001 --no-create-home --home-dir /tmp \
      --shell /usr/sbin/nologin neuralmri \
    && install -d -o 10001 -g 10001 -m 0750 /var/lib/neuralmri \
    && python -m pip uninstall --yes pip
COPY --from=build /opt/neuralmri /opt/neuralmri
COPY docker/worker_health.py /opt/neuralmri/worker_health.py
# The thread counts hold for the parent process; a job's own come from NEURALMRI_THREADS.
ENV PATH=/opt/neuralmri/bin:$PATH \
    HOME=/tmp \
    PYTHONDONTWRITEBYTECODE=1 \
    PYTHONUNBUFFERED=1 \
    OMP_NUM_THREADS=1 \
    OPENBLAS_NUM_THREADS=1 \
    NEURALMRI_DATA_DIR=/var/lib/neuralmri \
    NEURALMRI_LOG_FORMAT=json
WORKDIR /opt/neuralmri
USER 10001:10001
# On SIGTERM the worker hands its job back to the queue within seconds. REMAP_SIGTERM must stay unset:
# remapped to SIGQUIT, Celery would first let the job run on for the soft shutdown's time.
STOPSIGNAL SIGTERM
HEALTHCHECK --interval=30s --timeout=10s --start-period=30s --retries=3 \
  CMD ["python", "/opt/neuralmri/worker_health.py"]
CMD ["celery", "--app", "worker.app", "--quiet", "worker", "--concurrency", "1", \
     "--loglevel", "INFO", "--without-gossip", "--without-mingle"]

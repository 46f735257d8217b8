# The coordination service. Build: docker build -t marsupial .
FROM rust:1-slim-bookworm AS rust

FROM python:3.11-slim-bookworm AS build
RUN apt-get update \
 && apt-get install --yes --no-install-recommends gcc libc6-dev \
 && rm -rf /var/lib/apt/lists/*
COPY --from=rust /usr/local/cargo /usr/local/cargo
COPY --from=rust /usr/local/rustup /usr/local/rustup
ENV PATH=/usr/local/cargo/bin:$PATH RUSTUP_HOME=/usr/local/rustup CARGO_HOME=/usr/local/cargo
WORKDIR /build
COPY . .
# The lock pins what is installed; its development tools are not.
RUN python -m venv /opt/marsupial \
 && /opt/marsupial/bin/pip install --no-cache-dir --constraint requirements.lock \
    ".[postgres,telemetry]"

FROM python:3.11-slim-bookworm
RUN useradd --system --create-home --home-dir /var/lib/marsupial marsupial
COPY --from=build /opt/marsupial /opt/marsupial
ENV PATH=/opt/marsupial/bin:$PATH PYTHONUNBUFFERED=1 OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
USER marsupial
WORKDIR /var/lib/marsupial
EXPOSE 8080
# SIGTERM drains: streams end at once, requests under way get ten seconds each way.
STOPSIGNAL SIGTERM
HEALTHCHECK --interval=10s --timeout=3s --start-period=60s --retries=3 \
  CMD ["python", "-c", "import urllib.request as r; r.urlopen('http://127.0.0.1:8080/readyz', timeout=2)"]
ENTRYPOINT ["marsupial"]
CMD ["serve", "--host", "0.0.0.0", "--keys", "/run/secrets/keys", "--json-logs"]

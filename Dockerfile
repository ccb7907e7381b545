# kerf in a container:  docker build -t kerf .  &&  docker run --rm -v "$PWD:/work" kerf run CASE.toml
FROM debian:12-slim AS build
WORKDIR /kerf
COPY . .
RUN ./dev package

FROM debian:12-slim
COPY --from=build /kerf/build/package/packages/kerf_*.deb /kerf/build/package/packages/kerf-vtk_*.deb /tmp/
# openblas0-pthread: for UMFPACK, faster than the BLAS that would be chosen.
RUN apt-get update -q \
 && DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends libopenblas0-pthread /tmp/*.deb \
 && rm -rf /var/lib/apt/lists/* /tmp/*.deb
WORKDIR /work
ENTRYPOINT ["kerf"]

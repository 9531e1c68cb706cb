# docker build -t scarid .
# docker run --rm -i -v "$PWD:/data" -u "$(id -u):$(id -g)" scarid identify --robot scara2 log.csv
ARG PYTHON=3.13

FROM python:${PYTHON} AS build
COPY . /source
RUN pip wheel --no-deps --wheel-dir /wheels /source

FROM python:${PYTHON}-slim
RUN --mount=from=build,source=/wheels,target=/wheels \
    pip install --no-cache-dir "$(echo /wheels/*.whl)[urdf,logs]"
ENV HOME=/tmp
WORKDIR /data
ENTRYPOINT ["scarid"]
CMD ["--help"]

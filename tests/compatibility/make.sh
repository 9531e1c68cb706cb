#!/bin/sh
# Writes tables and the contract of this version into a folder of that name beside this script:
#   tests/compatibility/make.sh 0.1
# It is called once, at a release. Later versions read the files as they are.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
kept=$here/$1
build=$(mktemp -d)
trap 'rm -rf "$build"' EXIT
cp "$here"/../../samples/arm.toml "$here"/../../samples/arm.urdf "$build"
mkdir -p "$kept"
python "$here/contract.py" > "$kept/contract.json"
cd "$build"

export SCARID_ROBOT=scara2
scarid trajgen --seed 1 --duration 3 --rate 50 --expected expected.csv -o trajectory.parquet
scarid simulate --seed 1 --log-rate 50 trajectory.parquet -o measurement.parquet
scarid convert measurement.parquet -o measurement.csv
scarid convert measurement.parquet -o measurement.arrow
scarid tune --method kalman measurement.parquet --save settings.toml -o trials.csv
scarid differentiate --settings settings.toml measurement.parquet -o motion.parquet
scarid convert motion.parquet -o motion.csv
scarid identify --trace trace.parquet motion.parquet -o parameters.parquet
scarid convert --rows 1:20 trace.parquet -o trace.csv
scarid convert parameters.parquet -o parameters.csv
scarid validate --parameters parameters.parquet --predictions prediction.parquet motion.parquet \
  -o metrics.csv
scarid identify --estimator wls motion.parquet -o wls.parquet
scarid compare parameters.parquet wls.parquet -o comparison.csv

export SCARID_ROBOT=arm.toml
scarid trajgen --seed 1 --duration 4 -o arm-trajectory.parquet
scarid simulate --seed 1 arm-trajectory.parquet | scarid identify -o arm.parquet
scarid simulate --seed 2 --with payload=1,0,0,0,0,0,0,0,0,0,0 arm-trajectory.parquet -o loaded.parquet
scarid payload --parameters arm.parquet loaded.parquet -o payload.csv
scarid gains --parameters arm.parquet --mass 1 loaded.parquet -o gains.parquet

rm trace.parquet wls.parquet arm-trajectory.parquet loaded.parquet arm.toml arm.urdf
cp ./* "$kept"

#!/bin/sh
# From the wheel in build/dist to the first verdict, in an empty environment, as README says it:
#   sh packaging/first_minute.sh PYTHON FOLDER
# prints the transcript with its times and keeps it, and what was installed, in FOLDER.
set -eu
python=$1 folder=$2
wheel=$(echo build/dist/*.whl)
rm -rf "$folder"
mkdir -p "$folder"
ln -s "$PWD/samples" "$folder/samples"
now() { "$python" -c 'import time; print(time.time())'; }
since() { "$python" -c "import sys, time; print(f'# {time.time() - float(sys.argv[1]):.1f} s')" "$1"; }
start=$(now)
{
  echo "\$ pip install '$(basename "$wheel")[urdf,logs]'"
  "$python" -m venv "$folder/venv"
  "$folder/venv/bin/python" -m pip --disable-pip-version-check --quiet install "$wheel[urdf,logs]"
  since "$start"
  PATH=$PWD/$folder/venv/bin:$PATH
  sed -n '/^```sh$/,/^```$/p' README.md | sed -n '2,/^```$/p' | sed '$d' | while read -r line; do
    echo "\$ $line"
    (cd "$folder" && sh -c "$line" 2>&1)
    since "$start"
  done
} | tee "$folder/transcript.txt"
grep -q "scarid identify: good" "$folder/transcript.txt"  # the status of a pipe is that of tee
grep -q "scarid validate: unchanged" "$folder/transcript.txt"
"$folder/venv/bin/python" -m pip --disable-pip-version-check freeze --exclude scarid > "$folder/installed.txt"

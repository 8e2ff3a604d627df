#!/usr/bin/env bash
# usage: bench_checkpoint [CAPSOC]
# What a checkpoint of the main job takes: ten on its way, for each coprocessor, with the smallest, the median and the largest size
# and time, and how long the run itself takes with and without them.
set -euo pipefail
capsoc=$(realpath "${1:-build/capsoc}")
cd "$(mktemp -d)"
trap 'rm -rf "$PWD"' EXIT
shorter=(-P demodulation_samples=9000 -P calibration_samples=1000)
for coprocessor in tlm rtl lockstep; do
  saves=() options=("${shorter[@]}") last=40
  if [[ $coprocessor == tlm ]]; then options=() last=400; fi
  for part in 1 2 3 4 5 6 7 8 9 10; do saves+=(--save "$part.capsoc@$((last / 10 * part - last / 20))"); done
  run=("$capsoc" run --uart0 null --coprocessor "$coprocessor" "${options[@]}")
  begin=$EPOCHREALTIME
  "${run[@]}" 2>/dev/null || true  # too short for a pass
  plain=$(awk "BEGIN { print $EPOCHREALTIME - $begin }")
  begin=$EPOCHREALTIME
  "${run[@]}" --log-level info "${saves[@]}" 2>said || true
  sed -n 's/.*capsoc: \([0-9]*\) bytes in \([0-9.]*\) ms/\1 \2/p' said >times
  saved=$(awk "BEGIN { print $EPOCHREALTIME - $begin }")
  for column in 1 2; do sort -n -k "$column,$column" times | awk -v c="$column" '{ v[NR] = $c } END { print v[1], v[int((NR + 1) / 2)], v[NR] }' >"column$column"; done
  read -r least_size size most_size <column1
  read -r least_time time most_time <column2
  printf '%-9s %3d checkpoints  %7d bytes (%d .. %d)  %6.1f ms (%.1f .. %.1f)  run %.2f s, without %.2f s\n' "$coprocessor" \
    "$(wc -l <times)" "$size" "$least_size" "$most_size" "$time" "$least_time" "$most_time" "$saved" "$plain"
done

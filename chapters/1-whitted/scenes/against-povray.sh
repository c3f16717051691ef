#!/usr/bin/env bash
# Whitted's scene against POV-Ray, which traces the same rays: speed at one ray a pixel, then speed
# against error with antialiasing. One thread each; every program's own clock, without its start.
#
#   bash chapters/1-whitted/scenes/against-povray.sh [RUNS]
set -euo pipefail
export LC_ALL=C

fail() {
  echo "error: $1" >&2
  exit 1
}

runs=${1:-7}
[[ $runs =~ ^[1-9][0-9]*$ ]] || fail "RUNS is '$runs'; write a whole number from 1, such as 7"
command -v cargo >/dev/null || fail "there is no cargo; install Rust from https://rustup.rs"
command -v povray >/dev/null ||
  fail "there is no povray; install it, on Debian by: sudo apt install povray"

cd "$(dirname "${BASH_SOURCE[0]}")"
scene=$PWD/whitted.pov
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cargo build --release --quiet --package xtask

# Each renders to $folder/NAME.png and adds "seconds rays shadow-rays" to $folder/NAME.times.
lancer() {
  local name=$1
  shift
  cargo xtask render whitted --size 512x512 --threads 1 --out "$folder/$name.png" "$@" >"$folder/log"
  awk '$1 == "trace" { print $2, $6 + $8 + $10, $12 }' "$folder/log" >>"$folder/$name.times"
}
pov_ray() {
  local name=$1
  shift
  povray "+I$scene" "+O$folder/$name.png" +W512 +H512 +WT1 -D File_Gamma=srgb "$@" \
    >"$folder/log" 2>&1 || fail "POV-Ray says: $(tail -n 5 "$folder/log")"
  # The progress before the statistics stands on one line, with carriage returns.
  tr '\r' '\n' <"$folder/log" | awk '
    /^Rays:/ { rays = $2 }
    /^Shadow Ray Tests:/ { shadow = $4 }
    /Trace Time:/ { gsub(/.*\(| seconds\).*/, ""); print $0, rays, shadow }
  ' >>"$folder/$name.times"
}

# "median min max" of the seconds of NAME.
seconds() {
  cut -d ' ' -f 1 "$folder/$1.times" | sort -n | awk '
    { s[NR] = $1 }
    END { printf "%.3f %.3f %.3f\n", (s[int((NR + 1) / 2)] + s[int((NR + 2) / 2)]) / 2, s[1], s[NR] }'
}
# One of the metrics that compare prints.
metric() {
  awk -v name="$1" '$1 == name { print $2 }' "$folder/errors"
}
compare() {
  cargo xtask compare "$1" "$2" >"$folder/errors"
}

echo "One ray a pixel, 512x512, one thread, $runs runs in turn"
for ((run = 0; run < runs; run++)); do
  pov_ray pov-1 -A
  lancer lancer-1
done
printf '%-8s  %8s  %13s  %8s  %11s\n' program seconds 'min - max' rays 'shadow rays'
speed() {
  local name=$1 program=$2 median least most rays shadow
  read -r median least most < <(seconds "$name")
  read -r _ rays shadow <"$folder/$name.times"
  printf '%-8s  %8s  %5s - %5s  %8s  %11s\n' \
    "$program" "$median" "$least" "$most" "$rays" "$shadow"
}
speed pov-1 POV-Ray
speed lancer-1 lancer
read -r pov _ < <(seconds pov-1)
read -r ours _ < <(seconds lancer-1)
compare "$folder/pov-1.png" "$folder/lancer-1.png"
if ! awk -v psnr="$(metric PSNR)" 'BEGIN { exit !(psnr >= 35) }'; then
  echo "the pictures agree to $(metric PSNR) dB only: times of different pictures say nothing" >&2
  exit 1
fi
awk -v pov="$pov" -v ours="$ours" 'BEGIN { printf "POV-Ray takes %.2f times as long. ", pov / ours }'
echo "The pictures agree to a PSNR of $(metric PSNR) dB."
echo "(POV-Ray's shadow rays are its \"Shadow Ray Tests\"; it keeps the last blocker of each light.)"
echo

echo "Antialiasing: errors against 1024 samples a pixel of our own, both programs as 8-bit PNG"
cargo xtask render whitted --size 512x512 --spp 1024 --out "$folder/reference.exr" >"$folder/log"
for ((run = 0; run < runs; run++)); do
  pov_ray pov-AM1 +A0.1 +R3 +AM1
  pov_ray pov-AM2 +A0.1 +R3 +AM2
  for spp in 2 4 8 16; do
    lancer "lancer-spp-$spp" --spp "$spp"
  done
  for contrast in 0.1 0.05 0.02; do
    lancer "lancer-adaptive-$contrast" --spp 16 --adaptive "$contrast"
  done
done
# Two checks of the reference, once each: other samples of ours, and 9x9 rays in every pixel of
# POV-Ray's. What error they have left is mostly that of 8 bits.
lancer lancer-256 --spp 256 --seed 1
pov_ray pov-9x9 +A0.0 +R9 +AM1 -J
printf '%-32s  %8s  %13s  %9s  %6s  %8s\n' setting seconds 'min - max' RMSE PSNR FLIP
row() {
  local name=$1 setting=$2 median least most
  read -r median least most < <(seconds "$name")
  compare "$folder/reference.exr" "$folder/$name.png"
  printf '%-32s  %8s  %13s  %9.6f  %6.2f  %8.6f\n' \
    "$setting" "$median" "$least - $most" "$(metric RMSE)" "$(metric PSNR)" "$(metric FLIP)"
}
row pov-1 'POV-Ray -A'
row pov-AM1 'POV-Ray +A0.1 +R3 +AM1'
row pov-AM2 'POV-Ray +A0.1 +R3 +AM2'
row pov-9x9 'POV-Ray +A0.0 +R9 +AM1'
row lancer-1 'lancer  --spp 1'
for spp in 2 4 8 16; do
  row "lancer-spp-$spp" "lancer  --spp $spp"
done
for contrast in 0.1 0.05 0.02; do
  row "lancer-adaptive-$contrast" "lancer  --spp 16 --adaptive $contrast"
done
row lancer-256 'lancer  --spp 256'

#!/bin/sh
# Feeds the readers with what no program would write, until one of them fails or the time is over:
#
#     rustup toolchain install nightly; cargo install cargo-fuzz
#     sh tools/fuzz/run.sh xml          # ten minutes; also: legacy, mesh
#     sh tools/fuzz/run.sh mesh 60      # one minute
#
# A panic, an address that is not ours, ten seconds for one file, 300 MB in one piece or 2 GB in all is a failure. Its file is left
# under tools/fuzz/artifacts; `sh tools/fuzz/run.sh TARGET FILE` reads it again. The first run builds everything for the sanitizer.
# xz takes up to 100 MiB for its dictionary before the first byte; everything else must be in proportion to the file.
set -eu
cd "$(dirname "$0")/../.."
target=${1:?usage: sh tools/fuzz/run.sh xml|legacy|mesh [SECONDS|FILE]}
what=${2:-600}
# The versions that the tests run with.
[ -e tools/fuzz/Cargo.lock ] || cp Cargo.lock tools/fuzz/Cargo.lock
if [ -f "$what" ]; then
    exec cargo +nightly fuzz run "$target" "$what" --fuzz-dir tools/fuzz -- -timeout=10 -malloc_limit_mb=300 -rss_limit_mb=2048
fi
python3 tools/fuzz/seeds.py
exec cargo +nightly fuzz run "$target" --fuzz-dir tools/fuzz -- -dict="tools/fuzz/words/$target.dict" -max_len=16384 \
    -max_total_time="$what" -timeout=10 -malloc_limit_mb=300 -rss_limit_mb=2048 -print_final_stats=1

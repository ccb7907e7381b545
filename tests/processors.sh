#!/usr/bin/env bash
# processors.sh COMMAND...: runs a command as on several processors. OpenBLAS has other kernels for each, which round
# otherwise, and an optimization leads the last digit on to another design: what tests say of designs must hold for each.
set -u
failed=()
for kernels in HASWELL SKYLAKEX SANDYBRIDGE; do
  case $kernels in
    HASWELL) needs=avx2 ;;
    SKYLAKEX) needs=avx512f ;;
    SANDYBRIDGE) needs=avx ;;
  esac
  if ! grep -qw "$needs" /proc/cpuinfo; then
    echo "$kernels: left out, this processor has no $needs"
    continue
  fi
  echo "$kernels: $*"
  OPENBLAS_CORETYPE=$kernels "$@" || failed+=("$kernels")
done
[ ${#failed[@]} -eq 0 ] || { echo "failed with the kernels of ${failed[*]}"; exit 1; }

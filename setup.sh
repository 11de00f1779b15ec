#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: ./setup.sh VERB

  build     install what is missing (Debian 12, apt, as root) and build the program at build/strainwave,
            strainwave-devices beside it, and the C library of predictors with its example; what takes pictures of a
            bench where libopencv-videoio-dev and libopencv-imgcodecs-dev are installed
  demo      build, run schedules/quick.yaml on the simulated bench into a new folder under campaigns/, train a small
            predictor and show predicted against measured, then diagnose the transmission error of the first cycle:
            what a plain simulation would have got wrong
  package   build, and make Debian packages in build/packages/
  test      install what the tests need besides, build everything, then run all tests with ctest
  check     what takes long: format, links, the long tests, speed against the last table, the larger blind set, a minute
            of each fuzz target, asan, tsan, clang-tidy

A second run with nothing to do takes seconds. Exit code: 0, or that of the step that failed.
TEXT
}

# What the program is built from, and gnuplot, which draws its pictures.
BUILD_PACKAGES=(
  cmake ninja-build g++ ccache
  libeigen3-dev libhwy-dev libtbb-dev libyaml-cpp-dev nlohmann-json3-dev libcli11-dev libfmt-dev
  libhdf5-dev libmatio-dev libsndfile1-dev zlib1g-dev libsqlite3-dev libceres-dev libboost-dev libssl-dev
  libprotobuf-dev protobuf-compiler libonnx-dev libopencv-dnn-dev libopencv-ml-dev
  libmosquitto-dev libmodbus-dev libcpp-httplib-dev libiio-dev libcurl4-openssl-dev libpq-dev
  libhidapi-dev libsystemd-dev
  gnuplot-nox
)
# What takes pictures, a package of its own: 115 packages of Debian more. `build` makes it where they are.
CAMERA_PACKAGES=(libopencv-videoio-dev libopencv-imgcodecs-dev)
PACKAGE_PACKAGES=(dpkg-dev file python3 binutils "${CAMERA_PACKAGES[@]}")
TEST_PACKAGES=(
  "${PACKAGE_PACKAGES[@]}" git
  libgtest-dev libbenchmark-dev mosquitto openssl postgresql-15
  sqlite3 python3 python3-h5py python3-numpy python3-pywt python3-onnx
  python3-pymodbus python3-serial-asyncio python3-aiosmtpd socat
  can-utils python3-can iproute2 qemu-system-x86 busybox-static cpio kmod xz-utils binutils
  chromium nodejs libfuse3-dev
  munge slurmctld slurmd slurm-client
)
# In Debian a package of its own; nodejs from elsewhere brings it along.
command -v npm >/dev/null || TEST_PACKAGES+=(npm)
# Of those, what would begin to serve as soon as it is installed, and at every start of the machine.
SERVICES=(mosquitto munge slurmctld slurmd postgresql-15)
PROGRAMS=(strainwave strainwave-devices strainwave_manual strainwave_predictor predictor_example)

fail() {
  echo "setup.sh: error: $*" >&2
  exit 3
}

# missing PACKAGE...: those that are not installed, one a line.
missing() {
  local installed
  # dpkg-query fails when it knows one of the names not at all; what it knows it prints all the same.
  installed=$(dpkg-query --show --showformat='${Package} ${db:Status-Status}\n' "$@" 2>/dev/null || true)
  local package
  for package in "$@"; do
    grep -qxF "$package installed" <<<"$installed" || echo "$package"
  done
}

# install_with_apt PACKAGE...: no service begins; those of SERVICES that come new are not enabled either.
install_with_apt() {
  local services policy=/usr/sbin/policy-rc.d
  mapfile -t services < <(missing "${SERVICES[@]}")
  # Asked by Debian's packages before they start a service; a machine that has a policy of its own keeps it.
  if [[ ! -e $policy && ! -L $policy ]]; then
    trap "rm -f $policy" EXIT
    printf '#!/bin/sh\n# setup.sh is installing; it starts no services.\nexit 101\n' >"$policy"
    chmod 755 "$policy"
  fi
  apt-get -qq -o DPkg::Lock::Timeout=300 -o Dpkg::Use-Pty=0 \
    install --no-install-recommends --yes "$@" >/dev/null ||
    fail "apt-get could not install the packages named above (is there a network, are the apt sources right?)"
  if [[ -n $(trap -p EXIT) ]]; then
    rm -f "$policy"
    trap - EXIT
  fi
  local service
  for service in "${services[@]}"; do
    if [[ " $* " == *" $service "* ]]; then
      update-rc.d "${service%-15}" disable  # the service has no version
    fi
  done
}

# install_missing PACKAGE...
install_missing() {
  command -v dpkg-query >/dev/null || fail "this is not Debian: dpkg-query is missing (expected Debian 12)"
  local wanted
  mapfile -t wanted < <(missing "$@")
  if ((${#wanted[@]} == 0)); then
    return
  fi
  if ((EUID != 0)); then
    echo "setup.sh: error: ${#wanted[@]} packages are missing, and only root can install them; run" >&2
    echo "  apt-get update && apt-get install --no-install-recommends ${wanted[*]}" >&2
    local service
    for service in "${SERVICES[@]}"; do
      if [[ " ${wanted[*]} " == *" $service "* ]]; then
        echo "  systemctl disable --now ${service%-15}   # the tests start their own" >&2
      fi
    done
    exit 3
  fi
  echo "setup.sh: installing ${wanted[*]} (a few minutes)"
  export DEBIAN_FRONTEND=noninteractive
  # A foreign source that does not answer need not matter: what counts is whether the packages come.
  apt-get -qq update || echo "setup.sh: apt-get update had trouble; going on with the lists that there are" >&2
  install_with_apt "${wanted[@]}"
}

# The browser test's one package of npm, as tests/page/package-lock.json has it. Without it that test alone is skipped.
install_node_packages() {
  local folder=build/node
  if [[ -d $folder/node_modules ]] && cmp -s {tests/page,$folder}/package-lock.json; then
    return
  fi
  mkdir -p "$folder"
  cp tests/page/package{,-lock}.json "$folder"
  if ! npm ci --ignore-scripts --no-audit --no-fund --prefix "$folder" >"$folder/npm.txt" 2>&1; then
    rm -rf "$folder/node_modules"
    echo "setup.sh: npm could not fetch playwright-core and axe-core, see $folder/npm.txt; the test of the page in a browser is skipped" >&2
  fi
}

# build TARGET...: configures with the preset 'release' and builds.
build() {
  local fresh=()
  # A checkout that was copied together with its build folder: the old cache names the old place.
  if [[ -f build/CMakeCache.txt ]] && ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$PWD" build/CMakeCache.txt; then
    fresh=(--fresh)
  fi
  # Where everything that the tests need is there, whoever builds may also want to test.
  local tests=ON
  if [[ -n $(missing "${TEST_PACKAGES[@]}") ]]; then
    tests=OFF
  fi
  cmake --preset release --log-level=WARNING -D BUILD_TESTING=$tests "${fresh[@]}" >/dev/null
  cmake --build --preset release --parallel "$(nproc)" --target "$@"
}

# into_memory COMMAND...: with a temporary folder in memory where there is room for it. What is stored is written through
# to the disk, for which a test on a busy disk waits ten times as long as it computes.
into_memory() {
  local folder free_kB
  free_kB=$(df --output=avail /dev/shm 2>/dev/null | tail -n 1) || free_kB=0
  if ((free_kB < 3 * 1024 * 1024)) || ! folder=$(mktemp -d /dev/shm/strainwave.XXXXXX); then
    "$@"
    return
  fi
  (
    trap 'rm -rf "$folder"' EXIT
    chmod 711 "$folder"  # some tests look at a campaign as an ordinary user
    TMPDIR=$folder "$@"
  )
}

# run_tests PRESET. Tests whose devices live in real time wait more than they compute: they run beside the others, ahead of
# them, or, where priorities may not be raised, after them.
run_tests() {
  local preset=$1 status=0
  run_ctest() {
    into_memory "$@" --preset "$preset" --output-log build/tests_run.txt || status=$?
    tell_skipped build/tests_run.txt
  }
  if (($(nice -n -5 nice 2>/dev/null) < $(nice))); then
    run_ctest nice -n 15 ctest --parallel "$(($(nproc) + 1))"
  else
    run_ctest ctest --parallel "$(nproc)" --label-exclude real_time
    run_ctest ctest --label-regex real_time
  fi
  return "$status"
}

# tell_skipped RUN: what each test said that was skipped in the run of ctest with that output; ctest itself shows what
# a test said only when it fails.
tell_skipped() {
  awk '
    FNR == NR { if (/ \(Skipped\)$/) skipped[$3]; next }
    /^[0-9]+\/[0-9]+ Testing: / { name = $3; said = "" }
    /^<end of output>$/ { if (name in skipped) printf "skipped: %s\n%s", name, said; speaks = 0 }
    speaks && !/^-+$/ { said = said "  " $0 "\n" }
    /^Output:$/ { speaks = 1 }
  ' "$1" build/Testing/Temporary/LastTest.log
}

next_campaign() {
  local number=1
  while [[ -e campaigns/quick-$number ]]; do
    number=$((number + 1))
  done
  echo "campaigns/quick-$number"
}

# A small predictor, from the vibration of one reducer over 80 cycles of harder load than paper.yaml has.
predict_demo() {
  local folder=$1/predictor
  mkdir -p "$folder"
  echo "a predictor of transmission error and stiffness, from the vibration of 80 cycles of 4 h at 55 Nm (half a minute):"
  build/strainwave run schedules/life.yaml --out "$folder/life" >"$folder/run.txt"
  build/strainwave train "$folder/life" --out "$folder/trained"
  echo
  build/strainwave predict "$folder/trained" "$folder/life/cycles/000080.h5"
}

# step NAME COMMAND...: runs it, tells how long it took, and keeps the name of what failed: the steps behind it run, too.
step() {
  local name=$1 begun_s=$SECONDS code=0
  shift
  echo "== $name"
  "$@" || code=$?
  ((code == 0)) || failed_steps+=("$name (exit code $code)")
  echo "== $name: $( ((code == 0)) && echo passed || echo "FAILED with exit code $code"), $((SECONDS - begun_s)) s"
}

check_format() { git ls-files '*.h' '*.cc' | xargs clang-format-14 --dry-run --Werror; }

check_links() { tests/repository/references_test.py && tests/repository/documents_test.py; }

# tests/blind/README.md says why these numbers, and how small a loss they show.
check_blind() {
  tests/blind/run --seed 21 --cases 400 --clear --most-samples 20000 --jobs "$(nproc)" --timeout 1200 \
    --least-right 379 --most-wrong 6
}

check_tidy() {
  cmake --preset files --log-level=WARNING >/dev/null &&
    git ls-files '*.cc' ':!tests' | xargs -P "$(nproc)" -n 4 clang-tidy-14 --quiet -p build-files
}

# All tests but the sets that are run here by the program itself, and count names instead of memory errors. Signals
# are left to the program, whose own handlers stop the bench.
check_sanitized() {
  local -x ASAN_OPTIONS=handle_segv=0:handle_sigbus=0:handle_sigfpe=0:handle_sigill=0:handle_abort=0
  cmake --preset "$1" --log-level=WARNING >/dev/null &&
    cmake --build --preset "$1" --parallel "$(nproc)" &&
    ctest --preset "$1" --parallel "$(nproc)" --exclude-regex '^(blind_(fixed_set|clean_set|shared)|loggers_fixed_set)'
}

check_speed() { build predictor_benchmark && tests/benchmarks/run --check; }

check_long() { build all && run_tests long; }

check() {
  failed_steps=()
  step "format" check_format
  step "links and references" check_links
  step "program" build strainwave
  step "long tests" check_long
  step "speed beside other libraries" check_speed
  step "blind set" check_blind
  step "records as loggers leave them" tests/loggers/run --seed 1 --jobs "$(nproc)"
  step "fuzz targets" tests/fuzz/run_all.sh 60
  step "clang-tidy" check_tidy
  step "branches of the safety layer" tests/safety_coverage.sh
  step "asan" check_sanitized asan
  step "tsan" check_sanitized tsan
  if ((${#failed_steps[@]} > 0)); then
    printf 'setup.sh: check failed: %s\n' "${failed_steps[@]}" >&2
    return 1
  fi
}

cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")"
# A bare root has neither a locale nor, at times, a home; ccache needs a place of its own.
export LC_ALL=C.UTF-8
if [[ ! -w ${HOME:-/nonexistent} ]]; then
  export CCACHE_DIR="${CCACHE_DIR:-$PWD/build/ccache}"
fi

if (($# != 1)); then
  usage >&2
  exit 2
fi
case $1 in
  build)
    install_missing "${BUILD_PACKAGES[@]}"
    build "${PROGRAMS[@]}"
    ;;
  package)
    install_missing "${BUILD_PACKAGES[@]}" "${PACKAGE_PACKAGES[@]}"
    build "${PROGRAMS[@]}"
    /usr/bin/python3 packaging/sbom.py build --out build/packaging/strainwave.cdx.json || fail "of what is linked not all may be"
    rm -rf build/packages
    (cd build && cpack >cpack.txt 2>&1) || fail "cpack failed, see build/cpack.txt"
    rm -rf build/packages/_CPack_Packages
    ls build/packages/*.deb
    ;;
  demo)
    install_missing "${BUILD_PACKAGES[@]}"
    build strainwave
    mkdir -p campaigns
    campaign=$(next_campaign)
    build/strainwave run schedules/quick.yaml --out "$campaign"
    echo
    predict_demo "$campaign"
    echo
    exec build/strainwave diagnose "$campaign/cycles/000001.h5" --kind transmission_error --out "$campaign/diagnosis"
    ;;
  test)
    install_missing "${BUILD_PACKAGES[@]}" "${TEST_PACKAGES[@]}"
    install_node_packages
    build all
    run_tests release
    ;;
  check)
    install_missing "${BUILD_PACKAGES[@]}" "${TEST_PACKAGES[@]}" clang-format-14 clang-tidy-14 clang-14 llvm-14 libclang-rt-14-dev
    install_node_packages
    check
    ;;
  -h | --help)
    usage
    ;;
  *)
    echo "setup.sh: error: there is no verb '$1' (expected build, demo, package, test or check)" >&2
    usage >&2
    exit 2
    ;;
esac

#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs a test whose devices live in real time ahead of those beside it, which compute: `setup.sh test` runs these at a
# lower priority. Where a priority may not be raised it runs as it is.
# Usage: in_real_time.sh PROGRAM [ARGUMENT...]
renice --priority -5 --pid $$ >/dev/null 2>&1 || true
exec "$@"

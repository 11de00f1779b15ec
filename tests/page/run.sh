#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# tests/page/run.sh TEST PROGRAM FOLDER_OF_NODE_MODULES; exit code 77: skipped
command -v node >/dev/null || {
  echo "skipped, because there is no node (apt-get install nodejs)"
  exit 77
}
exec node "$@"

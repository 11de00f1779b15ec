#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Integers through sparkplug-payload and back.
# Package: npm sparkplug-payload 1.0.3 (with long and protobufjs as npm resolves them), Node.js 20.20.2.
# Input: metrics of valid types and values, encoded and decoded by the same library.
# Guess: what it encodes it decodes to the same number.
# What happens: an Int64 comes back as an object: adding 1 to it joins texts. In a DataSet, columns of Int8, Int32 and UInt8
#   are encoded, but then the payload, with all of its metrics, cannot be decoded; UInt64 neither; an Int64 below zero comes
#   back as one above 2^63.
# Seen:
#   | metric   Int64   5    -> object 5, plus one: 51
#   | metric   Int64   -5   -> object -5, plus one: -51
#   | metric   Int32   -5   -> number -5, plus one: -4
#   | DataSet  Double  -1.5 -> -1.5
#   | DataSet  Int8    -2   -> Error: Invalid DataSetValue: {"intValue":4294967294}
#   | DataSet  Int32   2    -> Error: Invalid DataSetValue: {"intValue":2}
#   | DataSet  UInt8   2    -> Error: Invalid DataSetValue: {"intValue":2}
#   | DataSet  UInt32  2    -> 2
#   | DataSet  Int64   2    -> 2
#   | DataSet  Int64   -2   -> 18446744073709551614
#   | DataSet  UInt64  2    -> Error: Invalid DataSetValue: {"longValue":"2"}
set -euo pipefail
source "$(dirname "$0")/packages.sh"
npm_packages sparkplug-payload@1.0.3

cat >both.js <<'END'
const sparkplug = require("sparkplug-payload").get("spBv1.0");

function both(kind, type, value, metric, show) {
  let said;
  try {
    const payload = {timestamp: 1700000000000, seq: 0, metrics: [{name: "m", timestamp: 1700000000000, ...metric}]};
    said = show(sparkplug.decodePayload(sparkplug.encodePayload(payload)).metrics[0].value);
  } catch (error) {
    said = `Error: ${error.message}`;
  }
  console.log(`${kind.padEnd(8)} ${type.padEnd(7)} ${String(value).padEnd(4)} -> ${said}`);
}

for (const [type, value] of [["Int64", 5], ["Int64", -5], ["Int32", -5]]) {
  both("metric", type, value, {type, value}, read => `${typeof read} ${read}, plus one: ${read + 1}`);
}
for (const [type, value] of [["Double", -1.5], ["Int8", -2], ["Int32", 2], ["UInt8", 2], ["UInt32", 2], ["Int64", 2],
                             ["Int64", -2], ["UInt64", 2]]) {
  const table = {numOfColumns: 1, columns: ["count"], types: [type], rows: [[value]]};
  both("DataSet", type, value, {type: "DataSet", value: table}, read => String(read.rows[0][0]));
}
END
seen node both.js
finish

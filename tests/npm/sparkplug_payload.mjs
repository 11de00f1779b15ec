// SPDX-License-Identifier: Apache-2.0
// usage: sparkplug_payload.mjs     decodes payloads, a line of hexadecimal digits each, to a line of JSON each
import {createRequire} from "node:module";
import {createInterface} from "node:readline";

const sparkplug = createRequire(`${process.env.STRAINWAVE_NPM}/`)("sparkplug-payload").get("spBv1.0");
for await (const line of createInterface({input: process.stdin})) {
  const payload = sparkplug.decodePayload(Buffer.from(line, "hex"));
  console.log(JSON.stringify({metrics: payload.metrics.map(({name, type, value, properties}) =>
    ({name, type, value: value !== null && typeof value === "object" ? Number(value) : value, properties}))}));
}

// SPDX-License-Identifier: Apache-2.0
// An exported predictor in ONNX Runtime: its golden vectors one by one and all together.
// usage: onnx_runtime.mjs FOLDER/model.onnx FOLDER/recipe.json     prints one JSON document
import {readFileSync} from "node:fs";
import {createRequire} from "node:module";

const ort = createRequire(`${process.env.STRAINWAVE_NPM}/`)("onnxruntime-node");
const [model, recipe] = process.argv.slice(2);
const golden = JSON.parse(readFileSync(recipe, "utf8")).self_test;
const session = await ort.InferenceSession.create(model);
const inputs = golden[0].features.length;

async function run(rows) {
  const features = new ort.Tensor("float32", Float32Array.from(rows.flatMap(row => row.features)), [rows.length, inputs]);
  const results = await session.run({features});
  return Object.fromEntries(Object.entries(results).map(([name, tensor]) => [name, {dims: tensor.dims, values: [...tensor.data]}]));
}

const alone = [];
for (const row of golden) alone.push(await run([row]));
console.log(JSON.stringify({golden, alone, together: await run(golden)}));

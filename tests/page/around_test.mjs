// SPDX-License-Identifier: Apache-2.0
// What stands around a campaign on the live page: lines in the trends, live channels as envelopes, a predictor beside the measured
// values, data sources with their losses, the camera's picture.
//
// usage: around_test.mjs PROGRAM FOLDER_OF_NODE_MODULES     exit code 77: skipped, a browser is not there
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {existsSync, mkdirSync, readFileSync, writeFileSync} from 'node:fs';
import {dirname, join, resolve} from 'node:path';
import {fileURLToPath} from 'node:url';
import {quantityName} from '../../bench/page/web/format.mjs';
import {linesOf, rangeWith} from '../../bench/page/web/lines.mjs';
import {launch, PATIENCE_MS, Scratch, until} from './browser.mjs';

const [program, modules] = process.argv.slice(2);
const TOP = resolve(dirname(fileURLToPath(import.meta.url)), '../..');
// One grey pixel.
const PICTURE = Buffer.from('/9j/4AAQSkZJRgABAQEASABIAAD/2wBDAP//////////////////////////////////////////////////////////////////////////////////////wgALCAABAAEBAREA/8QAFBABAAAAAAAAAAAAAAAAAAAAAP/aAAgBAQABPxA=', 'base64');

const browser = await launch(modules);
const scratch = new Scratch();
const at = (...path) => join(scratch.folder, ...path);
const run = (...words) => execFileSync(program, words, {stdio: 'ignore'});
const text = (tab, id) => tab.locator(`#${id}`).textContent();
const says = (tab, id, pattern) => until(async () => pattern.test(await text(tab, id)) && text(tab, id));

async function check(name, body) {
  await body();
  console.log(`passed: ${name}`);
}

/// A campaign that is over, of quick.yaml with some of its lines replaced.
function campaign(name, ...replaced) {
  let schedule = readFileSync(join(TOP, 'schedules/quick.yaml'), 'utf8');
  for (const [from, to] of replaced) {
    assert.ok(schedule.includes(from), from);
    schedule = schedule.replaceAll(from, to);
  }
  writeFileSync(at(`${name}.yaml`), schedule);
  run('run', at(`${name}.yaml`), '--out', at(name));
  return at(name);
}

/// A bench whose devices live within the program, with a camera.
function bench() {
  let text = readFileSync(join(TOP, 'tests/simulation/field/bench.yaml'), 'utf8');
  text = text.replaceAll('profile: drive.yaml', `profile: ${join(TOP, 'tests/simulation/field/drive.yaml')}`);
  text = text.replace('../../../bench/devices', join(TOP, 'bench/devices'));
  text = text.replace('\nchannels:', `  - {name: camera, kind: camera, address: "${at('frame_%d.ppm')}"}\n\nchannels:`);
  writeFileSync(at('bench.yaml'), text);
  return at('bench.yaml');
}

async function open(context, address, complaints) {
  const tab = await context.newPage();
  tab.setDefaultTimeout(PATIENCE_MS);
  tab.on('console', message => message.type() === 'error' && complaints.push(message.text()));
  tab.on('pageerror', error => complaints.push(String(error)));
  await tab.goto(address);
  return tab;
}

const asked = (tab, path) => tab.evaluate(where => fetch(where).then(answer => answer.json()), path);

try {
  await check('a forecast of a stop criterion is said in words, the end of an interval that has none too', () => {
    const stop = {below: 90}, control = null;
    const [, forecast] = linesOf({stop, forecast: {cycle: 101.4, low: 95, high: null, level: 0.95}, control});
    assert.deepEqual(forecast, {kind: 'forecast', at: [], words: 'forecast of that: cycle 101 (95 to never, 95 %)'});
    assert.equal(linesOf({stop, forecast: null, control}).length, 1);
  });

  await check('a line far away does not press the values together, until it is asked for', () => {
    const lines = [{at: [1.1]}, {at: [9]}];
    const [low, high] = rangeWith(0, 1, lines, false);
    assert.ok(low < 0 && high > 1.1 && high < 2, `${low} to ${high}`);
    assert.ok(rangeWith(0, 1, lines, true)[1] > 9);
    const [from, to] = rangeWith(3, 3, [], false);
    assert.ok(from < 3 && to > 3);
  });

  await check('quantities have their names and units', () => {
    assert.deepEqual(['k2_Nm_per_rad', 'e_max_arcmin', 'lost_motion_arcmin', 'score'].map(quantityName), ['K2, Nm/rad', 'e_max, arcmin', 'lost motion, arcmin', 'score']);
  });

  const context = await browser.newContext({viewport: {width: 1280, height: 900}});
  const complaints = [];
  const learnt = campaign('learnt', ['cycles: 12', 'cycles: 24'], ['resume:\n', 'stop: {e_max_above: 50 arcmin, k2_below_share_of_first: 0.9}\n\nresume:\n']);
  run('train', learnt, '--out', at('predictor'), '--set', 'orders', '--epochs', '10');
  const over = await scratch.page(program, learnt, 0, '--predictor', at('predictor'));
  const tab = await open(context, over.address, complaints);

  await check('stop criteria and control limits are lines that say what they are', async () => {
    await until(async () => await tab.locator('#charts canvas').count() === 6);
    const {lines} = await asked(tab, '/api/v1/cycles');
    const k2 = lines.k2_Nm_per_rad;
    assert.deepEqual([k2.control.first_cycle, k2.control.last_cycle, k2.control.cycles], [1, 20, 20]);
    const legend = (quantity, kind) => tab.locator(`#charts [data-quantity=${quantity}] .legend [data-kind=${kind}]`);
    const shown = value => new RegExp(Number(value.toPrecision(5)).toLocaleString('en-GB').replaceAll('.', '\\.'));
    const control = await legend('k2_Nm_per_rad', 'control').textContent();
    assert.match(control, /^control limits .* mean ± 2\.66 mean moving ranges of 20 cycles, 1 to 20$/);
    assert.match(control, shown(k2.control.lower));
    assert.match(control, shown(k2.control.upper));
    const stop = await legend('k2_Nm_per_rad', 'stop').textContent();
    assert.match(stop, /^the campaign ends below /);
    assert.match(stop, shown(k2.stop.below));
    assert.equal(await legend('k1_Nm_per_rad', 'stop').count(), 0);
    assert.ok(Math.abs(lines.e_max_arcmin.stop.above - 50) < 1e-9);
    const far = legend('e_max_arcmin', 'stop');
    assert.match(await far.textContent(), /^the campaign ends above 50 \(not in the picture, above it\)$/);
    await tab.locator('#all-lines').check();
    await until(async () => await far.textContent() === 'the campaign ends above 50');
    await tab.locator('#all-lines').uncheck();
    await until(async () => /not in the picture/.test(await far.textContent()));
  });

  await check('live channels show the smallest and the largest reading of the whole campaign', async () => {
    await until(async () => await tab.locator('#live-charts canvas').count() === 4);
    await tab.locator('#span').selectOption('whole');
    const {whole} = await asked(tab, '/api/v1/live');
    assert.ok(whole.bench_time_s.length <= 160);
    const {min, max} = whole['output torque'];
    const [low, high] = [Math.min(...min), Math.max(...max)];
    // The lock test goes to 34 Nm both ways, the load run to 40 Nm.
    assert.ok(low < -30 && high > 39 && high < 60, `${low} to ${high} Nm`);
    const output = tab.locator('#live-charts [data-quantity="output torque"] output');
    const digits = value => String(Number(value.toPrecision(5))).replace('-', '−');
    await until(async () => (await output.textContent()).startsWith(`${digits(low)} to ${digits(high)} Nm, last `));
    assert.match(await text(tab, 'live-charts-note'), /as the last run has left them$/);
    assert.match(await tab.locator('#live-charts [data-quantity="gear temperature"] h4').textContent(), /^gear temperature, °C$/);
  });

  await check('a predictor stands beside what was measured, with its interval', async () => {
    const row = tab.locator('#prediction [data-quantity=k2_Nm_per_rad]');
    await until(async () => await row.count() === 1);
    const {cycle, coverage, records} = await asked(tab, '/api/v1/prediction');
    assert.equal(cycle, 24);
    assert.equal(records.length, 1);
    assert.equal(records[0].outside_training, false);
    const said = records[0].values.k2_Nm_per_rad;
    const state = await asked(tab, '/api/v1/state');
    assert.equal(said.measured.value, state.results.k2_Nm_per_rad.value);
    assert.ok(said.low < said.value && said.value < said.high);
    assert.equal(said.inside, said.measured.value >= said.low && said.measured.value <= said.high);
    assert.match(await row.locator('td').nth(4).textContent(), said.inside ? /lies inside the interval$/ : /lies outside the interval$/);
    assert.match(await tab.locator('#prediction th').nth(3).textContent(), new RegExp(`^interval \\(${Math.round(100 * coverage)} %\\)$`));
    assert.equal(await tab.locator('#prediction .outside').count(), 0);
    assert.deepEqual(await asked(tab, '/api/v1/prediction?cycle=25'), {error: 'cycle 25 is not complete (expected at most 24)'});
  });

  await check('where the campaign is not one of its training, that is said in words', async () => {
    const other = campaign('other', ['cycles: 12', 'cycles: 1'], ['output_torque: 40 Nm', 'output_torque: 25 Nm']);
    const page = await scratch.page(program, other, 0, '--predictor', at('predictor'));
    const elsewhere = await open(context, page.address, complaints);
    const outside = elsewhere.locator('#prediction .outside');
    await until(async () => await outside.count() === 1);
    assert.match(await outside.textContent(), /^Outside of what the predictor was trained on \(.*output_torque_Nm is 2\d.*\): not valid\.$/);
    // Too few cycles for control limits, and no criterion: no line.
    await until(async () => await elsewhere.locator('#charts canvas').count() === 6);
    assert.equal(await elsewhere.locator('#charts .legend li').count(), 0);
    // Without a predictor there is no such part, nor a camera's without a camera.
    assert.equal(await elsewhere.locator('#picture-card').isVisible(), false);
    const plain = await open(context, (await scratch.page(program, other)).address, complaints);
    await says(plain, 'state-word', /^Complete/);
    assert.equal(await plain.locator('#prediction-card').isVisible(), false);
  });

  await check('data sources say in words how they are, what was lost since when, and when nothing is known', async () => {
    const real = scratch.start(program, ['run', join(TOP, 'tests/simulation/small.yaml'), '--bench', bench(), '--out', at('real')]);
    await until(() => existsSync(at('real/sources')) || real.exitCode !== null);
    assert.equal(real.exitCode, null, readFileSync(at('said.txt'), 'utf8'));
    const page = await scratch.page(program, at('real'));
    const watched = await open(context, page.address, complaints);
    const row = watched.locator('#sources [data-source=encoders]');
    await until(async () => /^✔ good$/.test(await row.locator('td').nth(1).textContent()));
    await until(async () => /^[1-9][\d,]* received, 0 lost, \d+ late or twice, since \d+ \w+ \d{4} \d\d:\d\d:\d\d$/.test(await row.locator('td').nth(2).textContent()));
    assert.equal(await row.locator('td').nth(3).textContent(), 'input angle, output angle, output torque');
    assert.match(await watched.locator('#sources [data-source=thermometers] td').nth(1).textContent(), /^✔ good$/);

    // The camera has no frames: that is said, and a picture is shown as soon as there is one.
    await says(watched, 'picture-note', /^stale: the camera has given no picture yet$/);
    assert.equal(await watched.locator('#picture').isVisible(), false);
    mkdirSync(at('real/cycles'), {recursive: true});
    writeFileSync(at('real/cycles/000000.jpg'), PICTURE);
    await says(watched, 'picture-note', /^of cycle 0, taken \d+ \w+ \d{4} \d\d:\d\d:\d\d, \d+ s ago$/);
    await until(() => watched.evaluate(() => document.getElementById('picture').naturalWidth === 1));
    assert.equal(await watched.locator('#picture').getAttribute('alt'), 'The bench after cycle 0');

    real.kill('SIGSTOP');
    await until(async () => /^✕ silent the program that runs the campaign has said nothing of it since \d+ \w+ \d{4} /.test(await row.locator('td').nth(1).textContent()));
    // Its drives have stopped by their own supervision meanwhile, so it may end by itself.
    real.kill('SIGCONT');
    await watched.locator('#stop').click();
    await real.ended;
    await until(async () => /^○ not running/.test(await row.locator('td').nth(1).textContent()));
  });

  assert.deepEqual(complaints.filter(words => !/status of (400|404)/.test(words)), []);
} finally {
  await browser.close();
  await scratch.close();
}

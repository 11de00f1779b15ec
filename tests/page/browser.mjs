// SPDX-License-Identifier: Apache-2.0
// Debian's Chromium through playwright-core, a campaign, and its page. What is missing is told, and the test is skipped.
import {execFileSync, spawn} from 'node:child_process';
import {existsSync, mkdtempSync, openSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {tmpdir} from 'node:os';
import {dirname, join, resolve} from 'node:path';
import {fileURLToPath} from 'node:url';

export const CHROMIUM = '/usr/bin/chromium';
const SMALL = resolve(dirname(fileURLToPath(import.meta.url)), '../simulation/small.yaml');
export const CYCLES = 200;
export const PATIENCE_MS = 60000;  // against hanging: no measure of anything
const SKIPPED = 77;

export function skip(why) {
  console.log(`skipped, because ${why}`);
  process.exit(SKIPPED);
}

/// playwright-core out of FOLDER/node_modules.
export function playwright(folder) {
  if (!existsSync(CHROMIUM)) skip(`there is no ${CHROMIUM} (apt-get install chromium)`);
  if (!['playwright-core', 'axe-core'].every(name => existsSync(join(folder, 'node_modules', name)))) {
    skip(`there are no playwright-core and axe-core in ${folder} (npm ci there, with tests/page/package.json; ./setup.sh test does it)`);
  }
  return createRequire(join(resolve(folder), 'package.json'))('playwright-core');
}

export function launch(folder) {
  // Chromium refuses to run as root with its sandbox.
  return playwright(folder).chromium.launch({executablePath: CHROMIUM, args: process.getuid() === 0 ? ['--no-sandbox'] : []});
}

/// What a test leaves behind is ended and removed in the end, whatever becomes of the test.
export class Scratch {
  folder = mkdtempSync(join(tmpdir(), 'strainwave-page-'));
  #processes = [];

  start(program, args, stdout = 'ignore') {
    const said = openSync(join(this.folder, 'said.txt'), 'a');
    const child = spawn(program, args, {stdio: ['ignore', stdout, said]});
    child.ended = new Promise(done => child.once('exit', (code, signal) => done(code ?? signal)));
    this.#processes.push(child);
    return child;
  }

  /// One of many short cycles, whose gear may twist so far.
  campaign(program, pace, {twist = '30 arcmin'} = {}, ...more) {
    const schedule = join(this.folder, 'schedule.yaml');
    const text = readFileSync(SMALL, 'utf8').replace('cycles: 3', `cycles: ${CYCLES}`).replace('20 min', '5 min');
    writeFileSync(schedule, text.replace('twist: 30 arcmin', `twist: ${twist}`));
    return this.start(program, ['run', schedule, '--out', join(this.folder, 'campaign'), '--pace', String(pace), ...more]);
  }

  /// A file of one user.
  users(program, name, password, role) {
    const file = join(this.folder, 'users.yaml');
    execFileSync(program, ['users', file, 'add', name, '--role', role], {input: `${password}\n`});
    return file;
  }

  /// The page's address, and its process.
  async page(program, campaign = join(this.folder, 'campaign'), port = 0, ...more) {
    const child = this.start(program, ['serve', campaign, '--port', String(port), ...more], 'pipe');
    const line = await new Promise((done, fail) => {
      child.stdout.once('data', data => done(String(data)));
      child.once('exit', code => fail(new Error(`strainwave serve ended with ${code}`)));
    });
    return {address: line.match(/https?:\/\/\S+/)[0], child};
  }

  async close() {
    for (const child of this.#processes) child.kill('SIGKILL');
    await Promise.all(this.#processes.map(child => child.ended));
    rmSync(this.folder, {recursive: true, force: true});
  }
}

export async function until(condition) {
  const deadline = performance.now() + PATIENCE_MS;
  while (performance.now() < deadline) {
    const value = await condition();
    if (value) return value;
    await new Promise(done => setTimeout(done, 20));
  }
  throw new Error(`it did not happen: ${condition}`);
}

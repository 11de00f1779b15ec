// SPDX-License-Identifier: Apache-2.0
// The page by the rules of axe-core (WCAG 2.1 A and AA, best practices): running with trends, tripped with an alarm, and each of its
// questions, at 1280 px and a phone's width, light and dark.
//
// usage: accessibility_test.mjs PROGRAM FOLDER_OF_NODE_MODULES     exit code 77: skipped, a browser is not there
import assert from 'node:assert/strict';
import {existsSync, readFileSync} from 'node:fs';
import {join} from 'node:path';
import {launch, PATIENCE_MS, Scratch, until} from './browser.mjs';

const [program, modules] = process.argv.slice(2);
const PACE = 200;
const AXE = readFileSync(join(modules, 'node_modules/axe-core/axe.min.js'), 'utf8');
const browser = await launch(modules);
const running = new Scratch(), tripped = new Scratch();

async function findings(tab) {
  // By the browser's own tools: the page's content policy lets no script in from elsewhere.
  await tab.evaluate(AXE);
  const {violations} = await tab.evaluate(() => window.axe.run(document, {resultTypes: ['violations']}));
  return violations.map(({id, help, nodes}) => `${id}: ${help}: ${nodes.map(node => `${node.target} (${node.failureSummary})`).join('; ')}`);
}

const found = [];
async function look(tab, what) {
  for (const finding of await findings(tab)) found.push(`${what}: ${finding}`);
}

try {
  assert.equal(await tripped.campaign(program, 'max', {twist: '5 arcmin'}).ended, 1);
  running.campaign(program, PACE);
  await until(() => existsSync(join(running.folder, 'campaign/readings')));
  const users = tripped.users(program, 'A. Meier', 'correct horse', 'operator');
  const run = await running.page(program);
  const trip = await tripped.page(program, undefined, 0, '--users', users);
  for (const colorScheme of ['light', 'dark']) {
    for (const [name, width, height] of [['wide', 1280, 900], ['phone', 390, 844]]) {
      const context = await browser.newContext({viewport: {width, height}, colorScheme});
      const tab = await context.newPage();
      tab.setDefaultTimeout(PATIENCE_MS);
      await tab.goto(run.address);
      await until(async () => await tab.locator('#charts canvas').count() === 6);
      await look(tab, `running, ${name}, ${colorScheme}`);

      await tab.goto(trip.address);
      await until(async () => await tab.locator('#alarms li').count() === 1);
      await tab.locator('#log-in').click();
      await look(tab, `login, ${name}, ${colorScheme}`);
      await tab.locator('#login-name').fill('A. Meier');
      await tab.locator('#login-password').fill('correct horse');
      await tab.keyboard.press('Enter');
      await until(async () => await tab.locator('#person').textContent() !== '');
      await tab.getByRole('button', {name: 'Shelve: alarm 1'}).click();
      await look(tab, `alarm and question, ${name}, ${colorScheme}`);
      await context.close();
    }
  }
  assert.deepEqual(found, []);
  console.log('passed: axe-core finds nothing');
} finally {
  await browser.close();
  await running.close();
  await tripped.close();
}

// SPDX-License-Identifier: Apache-2.0
// Pictures of the live page at 1280 px and at a phone's width, light and dark: a campaign that runs, and one that has tripped, with
// its alarm and a question about it. Those of docs/bench are two of them.
//
// usage: screenshots.mjs PROGRAM FOLDER_OF_NODE_MODULES OUT
import {existsSync} from 'node:fs';
import {join} from 'node:path';
import {launch, Scratch, until} from './browser.mjs';

const [program, modules, out] = process.argv.slice(2);
const PACE = 200;
const CYCLES_SHOWN = 6;
const PERSON = 'A. Meier', PASSWORD = 'correct horse';

const browser = await launch(modules);
const running = new Scratch(), tripped = new Scratch();

async function ofARun(tab, address, picture) {
  await tab.goto(address);
  await until(async () => await tab.locator('#charts canvas').count() === 6 && await tab.locator('#measurements canvas').count() === 3);
  await until(async () => parseInt(await tab.locator('#cycle').textContent(), 10) >= CYCLES_SHOWN);
  await tab.screenshot({path: picture('running'), fullPage: true});
}

async function ofATrip(tab, address, picture) {
  await tab.goto(address);
  await until(async () => await tab.locator('#alarms li').count() === 1);
  await tab.locator('#log-in').click();
  await tab.locator('#login-name').fill(PERSON);
  await tab.locator('#login-password').fill(PASSWORD);
  await tab.keyboard.press('Enter');
  await until(async () => await tab.locator('#person').textContent() !== '');
  await tab.screenshot({path: picture('alarm'), fullPage: true});
  await tab.getByRole('button', {name: 'Shelve: alarm 1'}).click();
  await tab.screenshot({path: picture('question')});
}

try {
  running.campaign(program, PACE);
  await tripped.campaign(program, 'max', {twist: '5 arcmin'}).ended;
  await until(() => existsSync(join(running.folder, 'campaign/readings')));
  const run = await running.page(program);
  const trip = await tripped.page(program, undefined, 0, '--users', tripped.users(program, PERSON, PASSWORD, 'operator'));
  for (const colorScheme of ['light', 'dark']) {
    for (const [name, width, height] of [['wide', 1280, 900], ['phone', 390, 844]]) {
      const context = await browser.newContext({viewport: {width, height}, colorScheme, deviceScaleFactor: name === 'phone' ? 2 : 1});
      const tab = await context.newPage();
      const picture = what => join(out, `${what}-${name}-${colorScheme}.png`);
      await ofARun(tab, run.address, picture);
      await ofATrip(tab, trip.address, picture);
      await context.close();
    }
  }
} finally {
  await browser.close();
  await running.close();
  await tripped.close();
}

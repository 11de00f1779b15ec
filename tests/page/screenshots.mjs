// SPDX-License-Identifier: Apache-2.0
// Pictures of the live page at 1280 px and at a phone's width, light and dark, of a campaign that runs.
//
// usage: screenshots.mjs PROGRAM FOLDER_OF_NODE_MODULES OUT [CAMPAIGN]     with CAMPAIGN: of one that is there already
import {existsSync} from 'node:fs';
import {join} from 'node:path';
import {launch, Scratch, until} from './browser.mjs';

const [program, modules, out, campaign] = process.argv.slice(2);
const PACE = 200;
const CYCLES_SHOWN = 6;

const browser = await launch(modules);
const scratch = new Scratch();
try {
  if (!campaign) {
    scratch.campaign(program, PACE);
    await until(() => existsSync(join(scratch.folder, 'campaign/readings')));
  }
  const {address} = await scratch.page(program, campaign);
  for (const colorScheme of ['light', 'dark']) {
    for (const [name, width, height] of [['wide', 1280, 900], ['phone', 390, 844]]) {
      const context = await browser.newContext({viewport: {width, height}, colorScheme, deviceScaleFactor: name === 'phone' ? 2 : 1});
      const tab = await context.newPage();
      await tab.goto(address);
      await until(async () => await tab.locator('#charts canvas').count() === 6);
      if (!campaign) await until(async () => parseInt(await tab.locator('#cycle').textContent(), 10) >= CYCLES_SHOWN);
      await tab.screenshot({path: join(out, `${name}-${colorScheme}.png`), fullPage: true});
      await context.close();
    }
  }
} finally {
  await browser.close();
  await scratch.close();
}

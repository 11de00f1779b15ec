// SPDX-License-Identifier: Apache-2.0
// What a tab that stays open holds over a whole campaign, as fast as the simulated bench can. By hand: paper.yaml takes
// six minutes and 5 GB of disk.
//
// usage: page_heap.mjs PROGRAM FOLDER_OF_NODE_MODULES SCHEDULE
import {existsSync} from 'node:fs';
import {join} from 'node:path';
import {launch, Scratch, until} from './browser.mjs';

const [program, modules, schedule] = process.argv.slice(2);
const EVERY_S = 15;
const FULL = 600;  // cycles: from there on a trend has all the points that it will have

const browser = await launch(modules);
const scratch = new Scratch();
try {
  const folder = join(scratch.folder, 'campaign');
  const campaign = scratch.start(program, ['run', schedule, '--out', folder]);
  await until(() => existsSync(join(folder, 'readings')));
  const {address} = await scratch.page(program);
  const context = await browser.newContext({viewport: {width: 1280, height: 900}});
  const tab = await context.newPage();
  await tab.goto(address);
  const session = await context.newCDPSession(tab);
  const held = [];
  const look = async () => {
    const cycle = parseInt(await tab.locator('#cycle').textContent(), 10);
    await session.send('HeapProfiler.collectGarbage');
    const {usedSize} = await session.send('Runtime.getHeapUsage');
    held.push({cycle, usedSize});
    console.log(`cycle ${cycle}: ${(usedSize / 1e6).toFixed(3)} MB`);
  };
  let code = null;
  campaign.ended.then(ended => { code = ended; });
  while (code === null) {
    await look();
    await Promise.race([campaign.ended, new Promise(done => setTimeout(done, EVERY_S * 1000))]);
  }
  await until(async () => /^Complete/.test(await tab.locator('#state-word').textContent()));
  await look();
  const full = held.filter(({cycle}) => cycle >= FULL);
  const change = full.at(-1).usedSize / full[0].usedSize - 1;
  console.log(`the campaign ended with ${code}; from cycle ${full[0].cycle} to the end: ${(100 * change).toFixed(1)} %`);
} finally {
  await browser.close();
  await scratch.close();
}

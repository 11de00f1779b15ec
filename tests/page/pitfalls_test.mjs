// SPDX-License-Identifier: Apache-2.0
// Of what operators complain about in such pages (docs/bench/page.md#pitfalls): memory that grows, actions that fire twice, times at
// the change of the clocks.
//
// usage: pitfalls_test.mjs PROGRAM FOLDER_OF_NODE_MODULES     exit code 77: skipped, a browser is not there
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {existsSync} from 'node:fs';
import {join} from 'node:path';
import {Clock} from '../../bench/page/web/format.mjs';
import {launch, PATIENCE_MS, Scratch, until} from './browser.mjs';

const [program, modules] = process.argv.slice(2);
const browser = await launch(modules);
const scratch = new Scratch();
const folder = join(scratch.folder, 'campaign');
const text = (tab, id) => tab.locator(`#${id}`).textContent();

async function check(name, body) {
  await body();
  console.log(`passed: ${name}`);
}

/// Bytes of JavaScript that are still used: the least of several collections, between which the page goes on, for one alone also counts
/// what it is working on.
async function heap(session) {
  let least = Infinity;
  for (let round = 0; round < 8; ++round) {
    await session.send('HeapProfiler.collectGarbage');
    least = Math.min(least, (await session.send('Runtime.getHeapUsage')).usedSize);
    await session.send('Runtime.evaluate', {expression: 'new Promise(done => requestAnimationFrame(() => done()))', awaitPromise: true});
  }
  return least;
}

const cycleOf = async tab => parseInt(await text(tab, 'cycle'), 10);
const journal = query => execFileSync('sqlite3', ['-readonly', join(folder, 'campaign.db'), query], {encoding: 'utf8'}).trim();

try {
  await check('10, times: the hour that comes twice, and the one that does not come, have their offset', () => {
    const clock = new Clock('Europe/Berlin');
    const shown = utc => `${clock.full(new Date(utc))} ${clock.offset(new Date(utc))}`;
    assert.equal(shown('2026-10-25T00:30:00Z'), '25 Oct 2026 02:30:00 UTC+02:00');
    assert.equal(shown('2026-10-25T01:30:00Z'), '25 Oct 2026 02:30:00 UTC+01:00');
    assert.equal(shown('2026-03-29T00:59:59Z'), '29 Mar 2026 01:59:59 UTC+01:00');
    assert.equal(shown('2026-03-29T01:00:00Z'), '29 Mar 2026 03:00:00 UTC+02:00');
  });

  const campaign = scratch.campaign(program, 2000);
  await until(() => existsSync(join(folder, 'readings')));
  const {address} = await scratch.page(program);
  const context = await browser.newContext({viewport: {width: 1280, height: 900}});
  const tab = await context.newPage();
  tab.setDefaultTimeout(PATIENCE_MS);
  await tab.goto(address);

  await check('1, memory: no more after the campaign than when all was drawn for the first time', async () => {
    const session = await context.newCDPSession(tab);
    const early = 100;  // cycles: the journal is full by then; trends have 600 points at most, some 2 kB each
    await until(async () => await cycleOf(tab) >= early && await tab.locator('#measurements canvas').count() === 3);
    const before = await heap(session);
    const late = 160;  // what comes next stops the campaign, which has to run until then
    await until(async () => await cycleOf(tab) >= late);
    const after = await heap(session);
    console.log(`heap: ${before} bytes in cycle ${early}, ${after} in cycle ${late}`);
    assert.ok(after < 1.1 * before, `${before} → ${after} bytes`);
    assert.ok(await tab.locator('#journal li').count() <= 40);
    assert.equal(await tab.locator('canvas').count(), 13);
  });

  await check('5, actions: two presses on one button ask once', async () => {
    await tab.locator('#stop').dblclick();
    assert.equal(await campaign.ended, 130);
    await until(async () => /^Stopped, safe$/.test(await text(tab, 'state-word')));
    await until(() => journal("SELECT COUNT(*) FROM events WHERE code = 'page_stop_now'") === '1');
    await tab.reload();
    await until(async () => /^Stopped, safe$/.test(await text(tab, 'state-word')));
    assert.equal(journal("SELECT COUNT(*) FROM events WHERE code = 'page_stop_now'"), '1');
  });
} finally {
  await browser.close();
  await scratch.close();
}

// SPDX-License-Identifier: Apache-2.0
// How long the live page takes: first useful paint, an event on the bench until it stands on the page, and what many
// viewers cost. By hand, on a quiet machine.
//
// usage: page_load.mjs PROGRAM FOLDER_OF_NODE_MODULES CAMPAIGN...
import {execFileSync} from 'node:child_process';
import {existsSync, readFileSync} from 'node:fs';
import {request} from 'node:http';
import {join} from 'node:path';
import {launch, Scratch, until} from './browser.mjs';

const [program, modules, ...campaigns] = process.argv.slice(2);
const LOADS = 10;
const VIEWERS = 50;
const PACE = 200;
const CLOCK_TICKS_PER_S = 100;  // of /proc/PID/stat
const WATCHED_S = 20;

const sorted = values => [...values].sort((a, b) => a - b);
const quantile = (values, share) => sorted(values)[Math.min(values.length - 1, Math.floor(share * values.length))];
const summary = values => `median ${quantile(values, 0.5).toFixed(0)} ms, p99 ${quantile(values, 0.99).toFixed(0)} ms, of ${values.length}`;

/// Until the state stands there, and until the trends do, from the beginning of the navigation.
async function paints(browser, address) {
  const useful = [], trends = [];
  for (let i = 0; i < LOADS; ++i) {
    const context = await browser.newContext({viewport: {width: 1280, height: 900}});
    const tab = await context.newPage();
    await tab.addInitScript(() => {
      const seen = () => {
        if (!window.usefulMs && document.getElementById('state')?.dataset.state !== 'loading' && document.getElementById('cycle')?.textContent !== '–') {
          requestAnimationFrame(() => window.usefulMs ??= performance.now());
        }
        if (!window.trendsMs && document.querySelectorAll('#charts canvas').length === 6) requestAnimationFrame(() => window.trendsMs ??= performance.now());
      };
      new MutationObserver(seen).observe(document, {subtree: true, childList: true, characterData: true, attributes: true});
    });
    await tab.goto(address);
    await tab.waitForFunction(() => window.usefulMs && window.trendsMs);
    useful.push(await tab.evaluate(() => window.usefulMs));
    trends.push(await tab.evaluate(() => window.trendsMs));
    await context.close();
  }
  return {useful, trends};
}

/// CPU time of a process, in seconds.
function cpu_s(pid) {
  const fields = readFileSync(`/proc/${pid}/stat`, 'utf8').split(') ')[1].split(' ');
  return (Number(fields[11]) + Number(fields[12])) / CLOCK_TICKS_PER_S;
}

const streams = (address, count) => Array.from({length: count}, () => {
  const stream = request(`${address}api/v1/events`);
  stream.on('response', response => response.resume());
  stream.on('error', () => {});
  stream.end();
  return stream;
});

/// One quick stop of a campaign that runs while others look on: how long its answer takes.
async function stop(address, tokenOf) {
  const state = await fetch(`${address}api/v1/state`).then(answer => answer.json());
  const begun = performance.now();
  const answer = await fetch(`${address}api/v1/actions`, {
    method: 'POST', headers: {'Content-Type': 'application/json'}, body: JSON.stringify({action: 'stop_now', run: state.run, token: tokenOf(state)}),
  });
  await answer.json();
  return {ms: performance.now() - begun, status: answer.status};
}

const browser = await launch(modules);
const scratch = new Scratch();
try {
  for (const campaign of campaigns) {
    const began = performance.now();
    const {address, child} = await scratch.page(program, campaign);
    console.log(`${campaign}: served after ${(performance.now() - began).toFixed(0)} ms`);
    const begun = performance.now();
    await fetch(`${address}api/v1/cycles?points=600`).then(answer => answer.text());
    console.log(`  cycles, read: ${(performance.now() - begun).toFixed(0)} ms`);
    const {useful, trends} = await paints(browser, address);
    console.log(`  first useful paint: ${summary(useful)}`);
    console.log(`  trends drawn:       ${summary(trends)}`);
    const before = cpu_s(child.pid);
    await new Promise(done => setTimeout(done, 5000));
    console.log(`  nobody looks on: ${(100 * (cpu_s(child.pid) - before) / 5).toFixed(1)} % of a core`);
    child.kill('SIGKILL');
  }

  const running = scratch.campaign(program, PACE);
  await until(() => existsSync(join(scratch.folder, 'campaign/readings')));
  const {address, child} = await scratch.page(program);
  const context = await browser.newContext();
  const tab = await context.newPage();
  await tab.goto(address);
  // From when readings were taken on the bench until the next paint; those that were there on connecting are older.
  const latencies = await tab.evaluate(seconds => new Promise(done => {
    const found = [];
    const source = new EventSource('/api/v1/events');
    let last = 0;
    source.addEventListener('state', event => {
      const state = JSON.parse(event.data);
      const age = state.ages_s.readings;
      if (age === null) return;
      const taken = state.now_ms - age * 1000;
      if (Math.abs(taken - last) < 5) return;
      const isFirst = last === 0;
      last = taken;
      if (isFirst) return;
      requestAnimationFrame(() => found.push(Date.now() - taken));
    });
    setTimeout(() => done(found), seconds * 1000);
  }), WATCHED_S);
  console.log(`readings taken on the bench until the next paint: ${summary(latencies)}`);
  const alone = cpu_s(child.pid);
  await new Promise(done => setTimeout(done, WATCHED_S * 1000));
  console.log(`one viewer, campaign at ${PACE} times real time: ${(100 * (cpu_s(child.pid) - alone) / WATCHED_S).toFixed(1)} % of a core`);
  const viewers = streams(address, VIEWERS);
  await new Promise(done => setTimeout(done, 1000));
  const many = cpu_s(child.pid);
  await new Promise(done => setTimeout(done, WATCHED_S * 1000));
  console.log(`${VIEWERS} viewers: ${(100 * (cpu_s(child.pid) - many) / WATCHED_S).toFixed(1)} % of a core`);
  const refused = [];
  for (let i = 0; i < 200; ++i) refused.push((await stop(address, () => 'none')).ms);
  console.log(`answer to an action, ${VIEWERS} viewers, refused: ${summary(refused)}`);
  const done = await stop(address, state => state.token);
  console.log(`quick stop, ${VIEWERS} viewers: ${done.ms.toFixed(0)} ms, ${done.status}; the campaign ended with ${await running.ended}`);
  for (const viewer of viewers) viewer.destroy();
  console.log(`memory of the page's program: ${execFileSync('ps', ['-o', 'rss=', '-p', String(child.pid)]).toString().trim()} kB`);
} finally {
  await browser.close();
  await scratch.close();
}

// SPDX-License-Identifier: Apache-2.0
// What a technician sees of a campaign that runs, and the quick stop, in Debian's Chromium.
//
// usage: live_page_test.mjs PROGRAM FOLDER_OF_NODE_MODULES     exit code 77: skipped, a browser is not there
import assert from 'node:assert/strict';
import {existsSync} from 'node:fs';
import {join} from 'node:path';
import {CYCLES, launch, PATIENCE_MS, Scratch, until} from './browser.mjs';

const [program, modules] = process.argv.slice(2);
const PACE = 200;
const TABS = 8;

const browser = await launch(modules);
const scratch = new Scratch();

/// A tab whose every complaint is kept: scripts that fail, files that do not come, what the content policy forbids.
async function open(context, address, complaints) {
  const tab = await context.newPage();
  tab.setDefaultTimeout(PATIENCE_MS);
  tab.on('console', message => message.type() === 'error' && complaints.push(message.text()));
  tab.on('pageerror', error => complaints.push(String(error)));
  await tab.goto(address);
  return tab;
}

const text = (tab, id) => tab.locator(`#${id}`).textContent();
const says = (tab, id, pattern) => until(async () => pattern.test(await text(tab, id)) && text(tab, id));

async function check(name, body) {
  await body();
  console.log(`passed: ${name}`);
}

try {
  const campaign = scratch.campaign(program, PACE);
  await until(() => existsSync(join(scratch.folder, 'campaign/readings')));
  const served = await scratch.page(program);
  const context = await browser.newContext({viewport: {width: 1280, height: 900}, timezoneId: 'Asia/Tokyo'});
  const complaints = [];
  const tab = await open(context, served.address, complaints);

  await check('state, phase and cycle follow the bench', async () => {
    await says(tab, 'state-word', /^Running$/);
    assert.equal(await tab.locator('#state').getAttribute('data-state'), 'running');
    assert.equal(await text(tab, 'state-shape'), '▶');
    const phase = await text(tab, 'phase');
    await until(async () => await text(tab, 'phase') !== phase);
    const cycle = await says(tab, 'cycle', new RegExp(`^\\d+ of ${CYCLES}$`));
    await until(async () => await text(tab, 'cycle') !== cycle);
    await says(tab, 'eta', /\d (s|min|h)/);
    await says(tab, 'eta-basis', /at the pace of this run, \d+ times real time/);
    await says(tab, 'life', /%$/);
    await says(tab, 'disk-note', /enough$/);
  });

  await check('readings stand beside their limits, with their age', async () => {
    const row = tab.locator('#live tr[data-quantity="output torque"]');
    await until(async () => /^−?[\d.]+ Nm$/.test(await row.locator('.now').textContent()));
    assert.equal(await row.locator('.limit').textContent(), '60 Nm');
    await until(async () => /^\d\.\d s$/.test(await row.locator('.age').textContent()));
  });

  await check('readings of a bench that is silent are grey and say since when', async () => {
    campaign.kill('SIGSTOP');
    const row = tab.locator('#live tr[data-quantity="input speed"]');
    await until(async () => /^no data since \d\d:\d\d:\d\d$/.test(await row.locator('.age').textContent()));
    assert.match(await row.getAttribute('class'), /\bold\b/);
    campaign.kill('SIGCONT');
    await until(async () => !/\bold\b/.test(await row.getAttribute('class') ?? ''));
  });

  await check('a page whose program is silent says so, until it speaks again', async () => {
    served.child.kill('SIGSTOP');
    await until(() => tab.locator('#banner').isVisible());
    assert.match(await text(tab, 'banner'), /^No data since \d\d:\d\d:\d\d: the program that serves this page does not answer/);
    assert.match(await tab.locator('body').getAttribute('class'), /\bold\b/);
    served.child.kill('SIGCONT');
    await until(() => tab.locator('#banner').isHidden());
  });

  await check('the journal is text, in the time of the bench', async () => {
    await until(async () => await tab.locator('#journal li').count() > 0);
    await says(tab, 'zone', /\(UTC([+-]\d\d:\d\d)?\)$/);
    assert.doesNotMatch(await text(tab, 'zone'), /Tokyo/);
    await tab.locator('#run-hours').check();
    assert.match(await tab.locator('#journal li time').first().textContent(), /^\d+\.\d\d h$/);
  });

  await check('trends are drawn when a cycle is complete', async () => {
    await until(async () => await tab.locator('#charts .chart canvas').count() === 6);
    assert.match(await tab.locator('#charts .chart output').first().textContent(), /^cycle \d+: [\d,]+ ± [\d.,]+ \(95 %\)/);
  });

  await check(`quick stop works in the last of ${TABS} tabs, and the bench is seen to be safe in all`, async () => {
    const tabs = [tab];
    while (tabs.length < TABS) tabs.push(await open(context, served.address, complaints));
    const last = tabs.at(-1);
    await says(last, 'state-word', /^Running$/);
    await last.locator('#stop').click();
    await says(last, 'answer', /^Quick stop: asked process \d+ for: quick stop|^The bench stands/);
    assert.equal(await campaign.ended, 130);
    await says(last, 'state-word', /^Stopped, safe$/);
    await says(last, 'answer', /^The bench stands: .*torque off, brakes on$/);
    for (const other of tabs) {
      await other.bringToFront();
      await says(other, 'state-word', /^Stopped, safe$/);
    }
    assert.equal(await text(last, 'state-shape'), '■');
    await last.bringToFront();
    await last.locator('#stop').click();
    await says(last, 'answer', /nobody runs this campaign: there is nobody to ask/);
  });

  await check('a page of an earlier run stops nothing of the next', async () => {
    // The page's requests are held back: it shows what it has seen last.
    const stale = await open(context, served.address, complaints);
    await says(stale, 'state-word', /^Stopped, safe$/);
    const seen = await stale.evaluate(() => fetch('/api/v1/state').then(answer => answer.json()));
    const next = scratch.campaign(program, PACE, {}, '--resume');
    await says(stale, 'state-word', /^Running$/);
    const answer = await stale.evaluate(({run, token}) => fetch('/api/v1/actions', {
      method: 'POST', headers: {'Content-Type': 'application/json'}, body: JSON.stringify({action: 'stop_now', run, token}),
    }).then(got => got.json()), seen);
    assert.equal(answer.why, 'stale');
    assert.equal(next.exitCode, null);
    // The same page knows the new run by now, and its own button stops that one.
    await stale.locator('#stop').click();
    await says(stale, 'state-word', /^Stopped, safe$/);
    assert.equal(await next.ended, 130);
  });

  await check('an operator logs in, sees an alarm, answers it, leaves a note and goes on', async () => {
    const PERSON = 'A. Meier', PASSWORD = 'correct horse';
    const tripped = new Scratch();
    try {
      assert.equal(await tripped.campaign(program, 'max', {twist: '5 arcmin'}).ended, 1);
      const users = tripped.users(program, PERSON, PASSWORD, 'operator');
      const {address} = await tripped.page(program, undefined, 0, '--users', users);
      const desk = await open(context, address, complaints);
      await says(desk, 'state-word', /^Fault, safe$/);
      const alarm = desk.locator('#alarms li[data-number="1"]');
      await until(async () => /not acknowledged/.test(await alarm.textContent()));
      assert.match(await alarm.textContent(), /▲ high.*twist/);
      assert.match(await desk.title(), /^\(1\) /);

      // A password that is wrong is answered in words; the right one after the time that it costs.
      await desk.locator('#log-in').click();
      await desk.locator('#login-name').fill(PERSON);
      await desk.locator('#login-password').fill('wrong horse');
      await desk.locator('#login-dialog button[type=submit]').click();
      await says(desk, 'login-trouble', /^no user of that name has that password$/);
      await until(async () => {
        await desk.locator('#login-password').fill(PASSWORD);
        await desk.locator('#login-dialog button[type=submit]').click();
        await until(async () => await desk.locator('#login-dialog').isHidden() || /again in/.test(await text(desk, 'login-trouble')));
        return desk.locator('#login-dialog').isHidden();
      });
      await says(desk, 'person', /^A\. Meier, operator$/);

      const asks = async (words) => {
        if (words !== undefined) await desk.locator('#ask-text').fill(words);
        await desk.locator('#ask-go').click();
      };
      await desk.locator('#acts [data-action=resume]').click();
      await asks('looked at it');
      await says(desk, 'ask-trouble', /^alarm 1 is not acknowledged: /);
      // No question covers the quick stop.
      await desk.locator('#stop').click();
      await says(desk, 'answer', /nobody runs this campaign/);
      await desk.locator('#ask-text').focus();
      await desk.keyboard.press('Escape');

      await alarm.getByRole('button', {name: 'Acknowledge'}).click();
      await asks('on my <b>way</b>');
      await until(async () => /acknowledged by A\. Meier/.test(await alarm.textContent()));
      await until(async () => /acknowledge: on my <b>way<\/b>/.test(await alarm.textContent()));

      await desk.locator('#add-note').click();
      await asks('brake & <script>alert(1)</script>');
      await until(async () => await desk.locator('#notes li').count() === 1);
      assert.equal(await desk.locator('#notes li .text').textContent(), 'brake & <script>alert(1)</script>');
      assert.equal(await desk.locator('#notes li .author').textContent(), PERSON);

      await alarm.getByRole('button', {name: 'Shelve'}).click();
      await desk.locator('#ask-length').selectOption('600');
      await asks();
      await until(async () => /shelved by A\. Meier until/.test(await alarm.textContent()));

      // It trips again at once: the same limit, the same gear. That is an alarm of its own, and the first is over by now.
      await desk.locator('#acts [data-action=resume]').click();
      await asks('brake adjusted');
      await until(async () => await desk.locator('#alarms li[data-number="2"]').count() === 1);
      await says(desk, 'state-word', /^Fault, safe$/);
      await until(async () => /resume asked for on the page by A\. Meier: brake adjusted/.test(await text(desk, 'journal')));

      await desk.locator('#log-out').click();
      await until(() => desk.locator('#log-in').isVisible());
      await desk.locator('#stop').click();
      await says(desk, 'answer', /nobody runs this campaign/);
    } finally {
      await tripped.close();
    }
  });

  // The page was silent once, and once it was told 409: the browser's own word for that, and no other.
  assert.deepEqual(complaints.filter(words => !/status of (400|401|409|429)/.test(words)), []);
} finally {
  await browser.close();
  await scratch.close();
}

// SPDX-License-Identifier: Apache-2.0
// What a browser on another machine sees of a page that is served to the network: nothing before the login, nothing after.
//
// usage: elsewhere_test.mjs PROGRAM FOLDER_OF_NODE_MODULES     exit code 77: skipped, a browser is not there
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {existsSync} from 'node:fs';
import {join} from 'node:path';
import {launch, PATIENCE_MS, Scratch, until} from './browser.mjs';

const [program, modules] = process.argv.slice(2);
const ELSEWHERE = '127.0.0.2';  // an address of this machine to which the page answers only since it is served at all of them

const browser = await launch(modules);
const scratch = new Scratch();
const text = (tab, id) => tab.locator(`#${id}`).textContent();
const says = (tab, id, pattern) => until(async () => pattern.test(await text(tab, id)) && text(tab, id));

async function check(name, body) {
  await body();
  console.log(`passed: ${name}`);
}

async function logIn(tab, password) {
  await tab.locator('#login-name').fill('A. Meier');
  await tab.locator('#login-password').fill(password);
  await tab.locator('#login-dialog button[type=submit]').click();
}

async function seesNothing(tab) {
  await says(tab, 'state-word', /^Log in to look on$/);
  await until(() => tab.locator('#login-dialog').isVisible());
  assert.ok(await tab.locator('main').isHidden());
  const page = await tab.locator('body').innerText();
  assert.doesNotMatch(page, /TEST-0001|load_run|load run|Running/);
  assert.equal(await tab.locator('#journal li').count(), 0);
}

try {
  const [key, certificate] = ['key.pem', 'certificate.pem'].map(name => join(scratch.folder, name));
  execFileSync('openssl', ['req', '-x509', '-newkey', 'ec', '-pkeyopt', 'ec_paramgen_curve:P-256', '-nodes', '-days', '2', '-subj', '/CN=bench',
    '-addext', `subjectAltName=IP:${ELSEWHERE}`, '-keyout', key, '-out', certificate], {stdio: 'ignore'});
  const campaign = scratch.campaign(program, 50);
  await until(() => existsSync(join(scratch.folder, 'campaign/readings')));
  const users = scratch.users(program, 'A. Meier', 'correct horse', 'viewer');
  const served = await scratch.page(program, undefined, 0, '--listen', '0.0.0.0', '--users', users, '--tls', certificate, key);
  const context = await browser.newContext({viewport: {width: 1280, height: 900}, ignoreHTTPSErrors: true});
  const tab = await context.newPage();
  tab.setDefaultTimeout(PATIENCE_MS);
  await tab.goto(served.address.replace('127.0.0.1', ELSEWHERE));

  await check('nothing is shown before the login, and the quick stop says what it needs', async () => {
    await seesNothing(tab);
    await tab.locator('#stop').click();
    await says(tab, 'answer', /nobody is, or the login is over/);
    await logIn(tab, 'wrong horse');
    await says(tab, 'login-trouble', /^no user of that name has that password$/);
    await seesNothing(tab);
  });

  await check('all is shown after it, and goes on', async () => {
    // A wrong password has made the next one wait.
    await until(async () => {
      await logIn(tab, 'correct horse');
      await until(async () => await tab.locator('#login-dialog').isHidden() || (await text(tab, 'login-trouble')) !== '');
      return await tab.locator('#login-dialog').isHidden();
    });
    await says(tab, 'state-word', /^Running$/);
    assert.ok(await tab.locator('main').isVisible());
    const elapsed = await text(tab, 'elapsed');
    await until(async () => await text(tab, 'elapsed') !== elapsed);
    assert.ok(await tab.locator('#banner').isHidden());
  });

  await check('nothing is shown after the logout, in other tabs neither', async () => {
    const other = await context.newPage();
    await other.goto(served.address.replace('127.0.0.1', ELSEWHERE));
    await says(other, 'state-word', /^Running$/);
    await tab.locator('#log-out').click();
    await seesNothing(tab);
    await seesNothing(other);
    await other.close();
  });

  await check('who can see the page can stop the bench, a viewer, too', async () => {
    await logIn(tab, 'correct horse');
    await says(tab, 'state-word', /^Running$/);
    await tab.locator('#stop').click();
    assert.equal(await campaign.ended, 130);
    await says(tab, 'state-word', /^Stopped, safe$/);
  });
} finally {
  await browser.close();
  await scratch.close();
}

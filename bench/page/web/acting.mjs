// SPDX-License-Identifier: Apache-2.0
// What people do on the page: log in, and act on one run with a token that is good once.
import {act, logIn, logOut} from '/api.mjs';

const $ = id => document.getElementById(id);

let token = '', tokenRun = '';
let user = null, hasUsers = false;
let shown = null;       // the run that is on the page
let refresh = () => {};
let tell = () => {};

const NAMES = {
  pause: ['Pause', 'Pause at the next checkpoint: torque off, brakes on.'],
  finish_cycle: ['Stop after this cycle', 'The cycle is finished, then torque off, brakes on.'],
  resume: ['Resume', 'The drives are enabled and the campaign goes on. Nobody may be at the bench.'],
  acknowledge: ['Acknowledge', 'You have seen it.'],
  confirm: ['Confirm', 'Its cause is mended.'],
  shelve: ['Shelve', 'It stays out of the way for this time. What it watches still stops the bench.'],
  unshelve: ['Take off the shelf', 'It is shown as before.'],
  comment: ['Comment', ''],
  note: ['Note', 'Kept in the campaign\'s journal.'],
};
const NEEDS_WORDS = new Set(['comment', 'note']);
const FOR_VIEWERS = new Set(['comment', 'note']);

export const nameOf = action => NAMES[action][0];
export const mayAct = action => user !== null && (user.role === 'operator' || FOR_VIEWERS.has(action));
export const canLogIn = () => hasUsers;

/// What a whole state brings: a token, and who is logged in.
export function takeState(state) {
  ({token, user} = state);
  tokenRun = state.run;
  hasUsers = state.has_users;
  $('person').textContent = user ? `${user.name}, ${user.role}` : '';
  $('log-in').hidden = !hasUsers || user !== null;
  $('log-out').hidden = user === null;
}

export const showsRun = run => { shown = run; };

/// Carried out once. A token of a program that was started again, or of another login, is replaced: the run that was seen is the
/// same, so is what was meant.
async function perform(action, more) {
  const run = shown ?? tokenRun;
  let answer = await act(action, run, token, more);
  if (answer.body.why === 'token' && answer.body.run === run) answer = await act(action, run, answer.body.token, more);
  if (answer.body.token) ({token} = answer.body);
  if (answer.body.why === 'stale' || answer.body.why === 'login') refresh();
  return answer;
}

/// @return whether it was asked for.
export async function quickStop() {
  tell('Quick stop: asking the bench …', 'asked');
  try {
    const answer = await perform('stop_now');
    if (answer.ok) tell(`Quick stop: ${answer.body.sentence}. Waiting until the bench stands.`, 'asked');
    else tell(`Quick stop: ${answer.body.error}`, answer.body.why === 'not_running' || answer.body.why === 'done' ? 'good' : 'bad');
    return answer.ok;
  } catch {
    tell('Quick stop: the page\'s program did not answer. Stop the bench by its own key, or with: strainwave stop DIR quick-stop', 'bad');
    return false;
  }
}

// Not modal: the quick stop stays in reach.
function open(dialog) {
  for (const other of document.querySelectorAll('dialog[open]')) other.close();
  dialog.show();
}

function login() {
  $('login-trouble').textContent = '';
  open($('login-dialog'));
  $('login-name').focus();
}

/// Nothing is shown without a login, since the page is looked at from another machine.
export function mustLogIn() {
  [token, user, hasUsers] = ['', null, true];
  $('person').textContent = '';
  $('log-in').hidden = false;
  $('log-out').hidden = true;
  if (!$('login-dialog').open) login();
}

/// Asks for words, then acts. @param about  what it is about, in a line; @param more  fields of the request.
export function ask(action, about = '', more = {}) {
  if (!mayAct(action)) {
    if (user === null) login();
    else tell(`${nameOf(action)} is for operators; ${user.name} is a viewer.`, 'bad');
    return;
  }
  $('ask-title').textContent = nameOf(action);
  $('ask-about').textContent = [about, NAMES[action][1]].filter(Boolean).join(' · ');
  $('ask-length-label').hidden = action !== 'shelve';
  $('ask-text-label').textContent = NEEDS_WORDS.has(action) ? 'Words' : action === 'resume' ? 'What was looked at and mended' : 'Why (may be left empty)';
  $('ask-text').value = '';
  $('ask-text').required = NEEDS_WORDS.has(action);
  $('ask-trouble').textContent = '';
  $('ask-go').textContent = nameOf(action);
  $('ask-dialog').dataset.action = action;
  $('ask-dialog').more = more;
  open($('ask-dialog'));
  $('ask-text').focus();
}

async function submitAsk(event) {
  event.preventDefault();
  const {action} = $('ask-dialog').dataset;
  const more = {...$('ask-dialog').more};
  if ($('ask-text').value.trim()) more.text = $('ask-text').value;
  if (action === 'shelve') more.for_s = Number($('ask-length').value);
  $('ask-go').disabled = true;
  try {
    const answer = await perform(action, more);
    $('ask-trouble').textContent = answer.ok ? '' : answer.body.error;
    if (answer.ok) {
      $('ask-dialog').close();
      tell(`${nameOf(action)}: ${answer.body.sentence}.`, 'good');
    }
  } catch {
    $('ask-trouble').textContent = 'The page\'s program did not answer; whether it was done is not known: look at the journal.';
  }
  $('ask-go').disabled = false;
}

async function submitLogin(event) {
  event.preventDefault();
  $('login-trouble').textContent = '';
  try {
    const answer = await logIn($('login-name').value.trim(), $('login-password').value);
    $('login-trouble').textContent = answer.ok ? '' : answer.body.error;
    if (!answer.ok) return;
    $('login-dialog').close();
    refresh();
  } catch {
    $('login-trouble').textContent = 'The page\'s program did not answer.';
  } finally {
    $('login-password').value = '';
  }
}

/// @param tools  refresh(): reads the state again; tell(text, kind): shows an answer.
export function begin(tools) {
  ({refresh, tell} = tools);
  $('log-in').addEventListener('click', login);
  $('log-out').addEventListener('click', async () => {
    await logOut().catch(() => {});
    refresh();
  });
  $('login-dialog').querySelector('form').addEventListener('submit', submitLogin);
  $('ask-dialog').querySelector('form').addEventListener('submit', submitAsk);
  for (const dialog of document.querySelectorAll('dialog')) {
    dialog.querySelector('.cancel').addEventListener('click', () => dialog.close());
    dialog.addEventListener('keydown', event => event.key === 'Escape' && dialog.close());
  }
  for (const button of $('acts').children) button.addEventListener('click', () => ask(button.dataset.action));
  $('add-note').addEventListener('click', () => ask('note'));
}

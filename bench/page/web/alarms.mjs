// SPDX-License-Identifier: Apache-2.0
// The open alarms and the newest notes, one item each.
import {ask, canLogIn, nameOf} from '/acting.mjs';

const $ = id => document.getElementById(id);
const SHAPES = {high: '▲', medium: '◆', low: '●'};

function element(tag, className, text) {
  const made = document.createElement(tag);
  made.className = className;
  made.textContent = text;
  return made;
}

function stateOf(alarm, clock) {
  const at = utc => clock.full(new Date(utc));
  const words = [`raised ${at(alarm.utc)} in cycle ${alarm.cycle}`];
  if (alarm.count > 1) words.push(`${alarm.count} times, last ${at(alarm.last_raised_utc)}`);
  if (alarm.count_in_floods) words.push(`${alarm.count_in_floods} of them in a flood`);
  words.push(alarm.active ? 'still there until the next run' : `returned ${at(alarm.returned_utc)}`);
  words.push(alarm.acknowledged ? `acknowledged by ${alarm.acknowledged.by}, ${at(alarm.acknowledged.utc)}` : 'not acknowledged');
  if (alarm.state === 'latched' || alarm.state === 'shelved_latched') words.push('stays until somebody confirms that its cause is mended');
  if (alarm.shelved) words.push(`shelved by ${alarm.shelved.by} until ${at(alarm.shelved.until_utc)}`);
  return words.join(' · ');
}

function item(alarm, clock) {
  const row = document.createElement('li');
  row.dataset.number = alarm.number;
  row.dataset.priority = alarm.priority;
  row.dataset.state = alarm.state;
  row.classList.toggle('shelved', Boolean(alarm.shelved));
  const head = document.createElement('p');
  head.className = 'alarm-head';
  head.append(element('span', 'priority', `${SHAPES[alarm.priority] ?? '▲'} ${alarm.priority}`), element('span', 'alarm-text', `${alarm.number}: ${alarm.text}`));
  if (alarm.first_out) head.append(element('span', 'first-out', 'first out'));
  row.append(head, element('p', 'note', stateOf(alarm, clock)));
  for (const line of alarm.guidance.split('\n').filter(Boolean)) row.append(element('p', 'guidance', `To do: ${line}`));
  for (const done of alarm.actions.filter(action => action.text)) {
    row.append(element('p', 'note said', `${clock.full(new Date(done.utc))} ${done.by || 'the program'}, ${done.action}: ${done.text}`));
  }
  if (canLogIn()) {
    const buttons = document.createElement('div');
    buttons.className = 'buttons';
    for (const action of alarm.may) {
      const button = element('button', 'small', nameOf(action));
      button.type = 'button';
      button.addEventListener('click', () => ask(action, `alarm ${alarm.number}: ${alarm.text}`, {alarm: alarm.number}));
      button.setAttribute('aria-label', `${nameOf(action)}: alarm ${alarm.number}`);
      buttons.append(button);
    }
    row.append(buttons);
  }
  return row;
}

const ORDER = {high: 0, medium: 1, low: 2};

/// Unacknowledged before acknowledged before shelved, high before low, older before newer.
export function inOrder(alarms) {
  const rank = alarm => (alarm.shelved ? 20 : alarm.acknowledged ? 10 : 0) + (ORDER[alarm.priority] ?? 0);
  return [...alarms].sort((a, b) => rank(a) - rank(b) || a.number - b.number);
}

export function showAlarms(alarms, clock) {
  const waiting = alarms.filter(alarm => !alarm.acknowledged && !alarm.shelved).length;
  $('alarms-card').hidden = alarms.length === 0;
  $('alarms-title').textContent = `Alarms: ${alarms.length} open, ${waiting} not acknowledged`;
  $('alarms').replaceChildren(...inOrder(alarms).map(alarm => item(alarm, clock)));
}

export function showNotes(notes, clock) {
  $('notes-none').hidden = notes.length > 0;
  $('notes').replaceChildren(...notes.map(note => {
    const row = document.createElement('li');
    row.append(element('time', 'muted', clock.full(new Date(note.utc))), element('span', 'author', note.author), element('span', 'text', note.text));
    return row;
  }));
}

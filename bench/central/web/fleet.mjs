// SPDX-License-Identifier: Apache-2.0
// The page of all benches: asks every few seconds, and puts what comes in as text nodes.
import {duration, number, quantityName} from '/format.mjs';

const EVERY_MS = 5000;
const PAGE = 200;
const element = id => document.getElementById(id);
const BAD = ['faulted', 'interrupted', 'silent', 'unreadable'];
const SHAPES = {running: '▶', complete: '✓', stopped: '■', faulted: '✕', interrupted: '✕', silent: '?', unreadable: '?'};

let from = 0;

async function ask(path, parameters) {
  const response = await fetch(`${path}?${new URLSearchParams(parameters)}`);
  const answer = await response.json();
  if (!response.ok) throw new Error(answer.error);
  return answer;
}

function row(cells) {
  const line = document.createElement('tr');
  for (const {text, kind = ''} of cells) {
    const cell = document.createElement('td');
    cell.className = kind;
    cell.textContent = text ?? '–';
    line.append(cell);
  }
  return line;
}

function tell(error) {
  element('trouble').hidden = !error;
  element('trouble').textContent = error ? error.message : '';
}

function stateKind(bench) {
  if (BAD.includes(bench.state)) return 'state-bad';
  if (bench.open_alarms > 0 || bench.clock_wrong) return 'state-warn';
  return bench.state === 'running' ? 'state-good' : '';
}

function clockWords(bench) {
  return bench.clock_wrong ? ` (its clock is ${duration(Math.abs(bench.clock_off_s))} ${bench.clock_off_s > 0 ? 'ahead' : 'behind'})` : '';
}

function showBenches(answer) {
  element('states').textContent = Object.entries(answer.states).map(([state, count]) => `${count} ${state}`).join(', ') || 'no benches';
  element('benches').replaceChildren(...answer.benches.map(bench => row([
    {text: bench.bench},
    {text: `${SHAPES[bench.state] ?? '○'} ${bench.state}`, kind: stateKind(bench)},
    {text: bench.specimen},
    {text: bench.schedule},
    {text: bench.cycles === null ? null : `${bench.complete} of ${bench.cycles}`},
    {text: bench.phase},
    {text: bench.open_alarms === null ? null : String(bench.open_alarms)},
    {text: bench.last_alarm && `${bench.last_alarm_utc.slice(0, 16).replace('T', ' ')}: ${bench.last_alarm}`, kind: 'words'},
    {text: bench.seen_s_ago === null ? null : `${duration(bench.seen_s_ago)} ago${clockWords(bench)}`},
  ])));
  const last = from + answer.benches.length;
  element('count').textContent = answer.count > 0 ? `${Math.min(from + 1, last)} to ${last} of ${answer.count}` : 'none';
  element('before').hidden = from === 0;
  element('next').hidden = last >= answer.count;
}

async function look() {
  try {
    showBenches(await ask('/api/v1/benches', {find: element('find').value, from}));
    tell(null);
  } catch (error) {
    tell(error);
  }
}

function change(campaign) {
  if (campaign.first === null || campaign.last === null || campaign.first === 0) return '–';
  return `${number(100 * (campaign.last - campaign.first) / Math.abs(campaign.first), 3)} %`;
}

async function compare(event) {
  event?.preventDefault();
  const quantity = element('quantity').value;
  if (!quantity) return;
  try {
    const answer = await ask('/api/v1/comparison', {quantity, query: element('query').value});
    element('compared').replaceChildren(...answer.campaigns.map(campaign => row([
      {text: campaign.specimen},
      {text: campaign.bench},
      {text: campaign.schedule},
      {text: number(campaign.first, 6), kind: 'number'},
      {text: number(campaign.last, 6), kind: 'number'},
      {text: String(campaign.last_cycle), kind: 'number'},
      {text: change(campaign), kind: 'number'},
    ])));
    element('compared-note').textContent = `${quantityName(quantity)}; ${answer.campaigns.length} campaigns` +
      (answer.campaigns.length === answer.most ? ', the first ones: narrow them down' : '');
    tell(null);
  } catch (error) {
    tell(error);
  }
}

function turn(rows) {
  from = Math.max(0, from + rows);
  look();
}

element('find').addEventListener('input', () => turn(-from));
element('before').addEventListener('click', () => turn(-PAGE));
element('next').addEventListener('click', () => turn(PAGE));
element('ask').addEventListener('submit', compare);

ask('/api/v1/quantities', {}).then(answer => {
  element('quantity').replaceChildren(...answer.quantities.map(name => new Option(quantityName(name), name)));
  return compare();
}).catch(tell);
look();
setInterval(look, EVERY_MS);

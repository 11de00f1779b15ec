// SPDX-License-Identifier: Apache-2.0
// What stands around the campaign: where its data come from, the camera's newest picture, what a predictor says.
import {duration, number, percent, quantityName, withInterval} from '/format.mjs';

const $ = id => document.getElementById(id);
const SHAPES = {good: '✔', 'losing samples': '▲', silent: '✕', trouble: '✕', 'not running': '○'};
const TO_95_PERCENT = 1.96;

function cells(row, ...texts) {
  for (const text of texts) row.insertCell().textContent = text;
}

function samplesOf(samples, clock) {
  if (!samples) return '';
  const since = clock.full(new Date(samples.since_utc));
  return `${number(samples.received, 12)} received, ${number(samples.lost, 12)} lost, ${number(samples.late, 12)} late or twice, since ${since}`;
}

/// Words carry times of UTC, as the journal has them.
export function showSources(sources, clock) {
  const body = $('sources').tBodies[0];
  body.replaceChildren();
  for (const source of sources) {
    const row = body.insertRow();
    row.dataset.source = source.source;
    row.dataset.state = source.state;
    const words = source.words.replace(/\d{4}-\d\d-\d\dT[\d:.]+Z/g, utc => clock.full(new Date(utc)));
    cells(row, source.source, '', samplesOf(source.samples, clock), source.channels.map(name => name.replaceAll('_', ' ')).join(', '));
    const condition = document.createElement('span');
    condition.className = 'condition';
    condition.textContent = `${SHAPES[source.state] ?? '?'} ${source.state}`;
    row.cells[1].append(condition, words ? ` ${words}` : '');
  }
}

let pictureShown = '';

/// @param since_s  since the state came.
export function showPicture(picture, since_s, clock) {
  $('picture-card').hidden = picture === null;
  if (picture === null) return;
  const taken = picture.name === null ? '' : `of cycle ${picture.cycle}, taken ${clock.full(new Date(picture.taken_utc))}, ${duration(picture.age_s + since_s)} ago`;
  const words = [taken, picture.stale && `stale: ${picture.stale}`].filter(Boolean).join(' · ');
  if ($('picture-note').textContent !== words) $('picture-note').textContent = words;
  $('picture').hidden = picture.name === null;
  $('picture').classList.toggle('stale', picture.stale !== '');
  const shown = `${picture.name} ${picture.taken_utc}`;
  if (picture.name === null || shown === pictureShown) return;
  pictureShown = shown;
  $('picture').alt = `The bench after cycle ${picture.cycle}`;
  $('picture').src = `/api/v1/picture?of=${encodeURIComponent(shown)}`;
}

function predictedRow(body, quantity, said) {
  const row = body.insertRow();
  row.dataset.quantity = quantity;
  const half = (said.high - said.low) / 2;
  const measured = said.measured ? withInterval(said.measured.value, TO_95_PERCENT * said.measured.standard_error) : 'not measured';
  const words = said.inside === null ? '' : said.inside ? 'the measured value lies inside the interval' : 'the measured value lies outside the interval';
  cells(row, quantityName(quantity), measured, withInterval(said.value, half), `${number(said.low, 5)} to ${number(said.high, 5)}`, words);
}

function recordOf(record, coverage) {
  const part = document.createElement('div');
  part.dataset.outside = record.outside_training;
  if (record.outside_training) {
    const outside = document.createElement('p');
    outside.className = 'outside';
    outside.textContent = `Outside of what the predictor was trained on (${record.outside}): not valid.`;
    part.append(outside);
  }
  const note = document.createElement('p');
  note.className = 'muted';
  note.textContent = [record.group, `${record.windows} ${record.windows === 1 ? 'window' : 'windows'}`, ...record.warnings].filter(Boolean).join(' · ');
  part.append(note);
  if (record.class !== undefined) {
    const classes = document.createElement('p');
    classes.textContent = `class ${record.class}: ${Object.entries(record.probabilities).map(([name, share]) => `${name} ${percent(share, 1)}`).join(', ')}`;
    part.append(classes);
    return part;
  }
  const table = document.createElement('table');
  table.className = 'prediction';
  const head = table.createTHead().insertRow();
  for (const title of ['quantity', 'measured (95 %)', 'predicted', `interval (${percent(coverage)})`, 'compared']) {
    const cell = document.createElement('th');
    cell.scope = 'col';
    cell.textContent = title;
    head.append(cell);
  }
  const body = table.createTBody();
  for (const [quantity, said] of Object.entries(record.values)) predictedRow(body, quantity, said);
  part.append(table);
  return part;
}

export function showPrediction(answer) {
  $('prediction-note').textContent = answer.records.length ? `cycle ${answer.cycle}` : 'The cycle has no record of vibration.';
  $('prediction').replaceChildren(...answer.records.map(record => recordOf(record, answer.coverage)));
}

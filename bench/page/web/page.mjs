// SPDX-License-Identifier: Apache-2.0
// The live page: what the bench says, put into the document. Text goes in as text, never as markup.
import {begin, canLogIn, mayAct, mustLogIn, quickStop, showsRun, takeState} from '/acting.mjs';
import {showAlarms, showNotes} from '/alarms.mjs';
import {getAlarms, getCycles, getLive, getMeasurements, getPrediction, getState} from '/api.mjs';
import {showPicture, showPrediction, showSources} from '/around.mjs';
import {follow} from '/feed.mjs';
import {Clock, bytes, duration, fixed, hours, number, percent} from '/format.mjs';

const SILENT_MS = 3000;        // without a word the stream counts as down
const OLD_S = 2;               // from then on a reading is no reading of now
const TICK_MS = 250;
const CYCLES_EVERY_MS = 2000;  // at most so often, however fast a simulated bench runs
const MEASUREMENTS_EVERY_MS = 5000;
const LIVE_EVERY_MS = 2000;
const PREDICTION_EVERY_MS = 5000;
const POINTS = 600;
const LINES = 40;

const STATES = {
  running: ['▶', 'Running'], stopped: ['■', 'Stopped, safe'], complete: ['✔', 'Complete, safe'], faulted: ['▲', 'Fault, safe'],
  interrupted: ['?', 'Interrupted, not known to be safe'], not_begun: ['○', 'Not begun'], unreadable: ['✕', 'Cannot be read'],
};

const $ = id => document.getElementById(id);
const put = (id, text) => {
  if ($(id).textContent !== text) $(id).textContent = text;
};

let state = null;         // the newest
let stateAt = 0;          // when it came, on this browser's steady clock
let wordAt = 0;           // when anything came
let benchMs = 0;          // UTC of the bench then
let clock = new Clock('UTC');
let locked = false;       // nothing is shown without a login
let asked = false;        // for a quick stop, and the bench was not seen to stand since

function bar(id, share) {
  const known = Number.isFinite(share);
  const inside = Math.min(1, Math.max(0, known ? share : 0));
  $(id).firstElementChild.style.width = `${100 * inside}%`;
  if (known) $(id).setAttribute('aria-valuenow', Math.round(100 * inside)); else $(id).removeAttribute('aria-valuenow');
}

function showState() {
  const [shape, word] = STATES[state.state] ?? ['?', state.state];
  $('state').dataset.state = state.state;
  put('state-shape', shape);
  put('state-word', word);
  put('sentence', state.state === 'running' ? state.sentence.replaceAll('_', ' ') : state.sentence);
  put('campaign', state.campaign);
  put('specimen', state.specimen);
  put('run', state.run);
  const waiting = state.alarms.filter(alarm => !alarm.acknowledged && !alarm.shelved).length;
  document.title = `${waiting ? `(${waiting}) ` : ''}${word} · ${state.campaign}`;
}

function showProgress() {
  put('phase', state.phase.replaceAll('_', ' '));
  bar('phase-bar', state.phase_share);
  put('phase-note', state.phase_share === null ? state.phase_outcome : `${percent(state.phase_share)} done, ${state.phase_outcome}`);
  put('cycle', state.cycle === 0 ? 'preparation' : `${state.cycle} of ${state.cycles}`);
  bar('share-bar', state.share);
  put('cycle-note', `${state.cycles_complete} complete, ${percent(state.share, 1)} of the campaign`);
  put('eta', state.state === 'complete' ? 'none' : duration(state.eta_s));
  put('eta-end', state.expected_end_utc ? `ends ${clock.full(new Date(state.expected_end_utc))}` : '');
  put('eta-basis', state.state === 'complete' ? '' : state.eta_basis);
  put('elapsed', hours(state.bench_time_s));
  put('credited', `${hours(state.credited_load_s)} of load credited`);
  put('life', state.life_share === null ? '–' : `${number(100 * state.life_share, 3)} %`);
  const disk = state.disk;
  const little = disk && disk.free_bytes < disk.needed_bytes;
  $('disk-tile').classList.toggle('little', Boolean(little));
  put('disk', disk ? `${bytes(disk.free_bytes)} free` : '–');
  put('disk-note', !disk ? 'not known' : little ? `too little, full in about ${duration(disk.lasts_s)}: ${bytes(disk.needed_bytes)} may be needed` : `${bytes(disk.needed_bytes)} may be needed, enough`);
}

function liveRow(quantity) {
  const body = $('live').tBodies[0];
  for (const row of body.rows) if (row.dataset.quantity === quantity) return row;
  const row = body.insertRow();
  row.dataset.quantity = quantity;
  for (const name of ['quantity', 'now', 'meter', 'limit', 'age']) {
    const cell = row.insertCell();
    cell.className = name === 'now' || name === 'limit' || name === 'age' ? `${name} number` : name;
  }
  const track = document.createElement('div');
  track.className = 'track';
  track.append(document.createElement('div'));
  row.cells[2].append(track);
  row.cells[0].textContent = quantity;
  return row;
}

const UNITS = {degC: '°C', 'm/s2': 'm/s²'};

// Ages go on while nothing comes.
function showLive() {
  const since = (performance.now() - stateAt) / 1000;
  $('live').hidden = state.values.length === 0;
  $('live-none').hidden = state.values.length > 0;
  if (!state.values.length) put('live-none', state.process > 0 ? 'No reading yet.' : 'Nobody runs the campaign: there are no readings of now.');
  for (const value of state.values) {
    const row = liveRow(value.quantity);
    const unit = UNITS[value.unit] ?? value.unit;
    const age = value.age_s === null ? null : value.age_s + since;
    const old = age === null || age > OLD_S || value.value === null;
    row.classList.toggle('old', old);
    const decimals = Math.min(6, Math.max(0, 3 - Math.floor(Math.log10(value.limit))));
    const words = [
      value.value === null ? `– (${value.missing})` : `${fixed(value.value, decimals)} ${unit}`,
      `${number(value.limit)} ${unit}`,
      age === null ? 'not known' : age > OLD_S ? `no data since ${clock.time(new Date(benchMs + since * 1000 - age * 1000))}` : `${age.toFixed(1)} s`,
    ];
    [1, 3, 4].forEach((cell, i) => {
      if (row.cells[cell].textContent !== words[i]) row.cells[cell].textContent = words[i];
    });
    const share = value.value === null ? 0 : Math.min(1, Math.abs(value.value) / value.limit);
    const track = row.cells[2].firstElementChild;
    track.classList.toggle('near', share > 0.9);
    track.firstElementChild.style.width = `${100 * share}%`;
  }
}

function showLine(line) {
  if ([...$('journal').children].some(known => known.dataset.id === String(line.id))) return;
  const item = document.createElement('li');
  item.dataset.id = line.id;
  item.dataset.utc = line.utc;
  item.dataset.benchTime = line.bench_time_s;
  const time = document.createElement('time'), cycle = document.createElement('span'), severity = document.createElement('span'), text = document.createElement('span');
  time.dateTime = line.utc;
  cycle.className = 'cycle';
  cycle.textContent = `cycle ${line.cycle}`;
  severity.dataset.severity = line.severity;
  severity.textContent = line.severity;
  text.className = 'text';
  text.textContent = line.text;
  item.append(time, cycle, severity, text);
  const before = [...$('journal').children].find(known => Number(known.dataset.id) < line.id);
  $('journal').insertBefore(item, before ?? null);
  while ($('journal').children.length > LINES) $('journal').lastElementChild.remove();
  showTimes(item);
}

function showTimes(...items) {
  const benchHours = $('run-hours').checked;
  for (const item of items) {
    item.firstElementChild.textContent = benchHours ? hours(Number(item.dataset.benchTime)) : clock.full(new Date(item.dataset.utc));
  }
}

function showAllLines() {
  for (const chart of charts) chart.show($('all-lines').checked);
}

// Charts come after everything else: the first paint waits for no history.
const charts = [];
let cyclesShown = -1, cyclesAsked = -Infinity, cyclesUnderWay = false;

async function showCycles() {
  const due = state && state.cycles_complete > 0 && state.cycles_complete !== cyclesShown && performance.now() - cyclesAsked > CYCLES_EVERY_MS;
  if (!due || cyclesUnderWay || document.visibilityState !== 'visible') return;
  cyclesUnderWay = true;
  cyclesAsked = performance.now();
  try {
    const [answer, {TRENDS, Trend}] = await Promise.all([getCycles(POINTS), import('/charts.mjs')]);
    if (!charts.length) charts.push(...TRENDS.map(trend => new Trend($('charts'), trend)));
    for (const chart of charts) chart.set(answer, $('all-lines').checked);
    cyclesShown = answer.cycles_complete;
    put('trends-note', answer.bin_cycles > 1
      ? `${answer.bin_cycles} cycles a point: band from the smallest to the largest, line through the last, faint band its 95 % interval`
      : 'line: each cycle; faint band: its 95 % interval');
  } catch (error) {
    put('trends-note', `The cycles cannot be shown: ${error.message}`);
  }
  cyclesUnderWay = false;
}

// What cannot be done now is not offered: pausing where nothing runs, going on where something does.
function showActs() {
  $('acts').hidden = !canLogIn();
  $('add-note').hidden = !canLogIn();
  for (const button of $('acts').children) {
    const fits = (button.dataset.action === 'resume') === (state.process === 0) && state.state !== 'complete' && state.state !== 'unreadable';
    button.disabled = !fits;
    button.title = fits && !mayAct(button.dataset.action) ? 'needs the login of an operator' : '';
  }
}

// Alarms with what was said about them, read again when one of them has changed.
let alarmsShown = '', notesShown = '';

async function showLists() {
  const notes = JSON.stringify([state.notes, clock.zone]);
  if (notes !== notesShown) showNotes(state.notes, clock);
  notesShown = notes;
  const alarms = JSON.stringify([state.alarms, clock.zone, canLogIn()]);
  if (alarms === alarmsShown) return;
  alarmsShown = alarms;
  showAlarms(state.alarms, clock);
  if (!state.alarms.length) return;
  try {
    const {alarms: whole} = await getAlarms();
    if (alarmsShown === alarms) showAlarms(whole, clock);
  } catch {
    alarmsShown = '';  // with the next state
  }
}

// The first cycle is read once for a campaign; the newest when there is another, and not more often than every few seconds.
let pictures = null, first = null, measuredShown = -1, measuredAsked = -Infinity, measuredUnderWay = false;

async function showMeasurements() {
  const due = state && state.cycles_complete > 0 && state.cycles_complete !== measuredShown && performance.now() - measuredAsked > MEASUREMENTS_EVERY_MS;
  if (!due || measuredUnderWay || document.visibilityState !== 'visible') return;
  measuredUnderWay = true;
  measuredAsked = performance.now();
  try {
    first ??= await getMeasurements(1);
    const [newest, {makePictures}] = await Promise.all([getMeasurements(0), import('/curves.mjs')]);
    pictures ??= makePictures($('measurements'));
    for (const picture of pictures) picture.set(newest.cycle > 1 ? [first, newest] : [newest]);
    measuredShown = newest.cycle;
    put('measurements-note', '');
  } catch (error) {
    put('measurements-note', `The measurements cannot be shown: ${error.message}`);
  }
  measuredUnderWay = false;
}

// Envelopes of the live channels: while the campaign runs, and once of one that does not.
let liveCharts = null, liveAsked = -Infinity, liveUnderWay = false, liveShown = '';

async function showEnvelopes() {
  const which = `${state?.run} ${state?.process} ${$('span').value}`;
  const due = state && (state.process > 0 || which !== liveShown) && performance.now() - liveAsked > LIVE_EVERY_MS;
  if (!due || liveUnderWay || document.visibilityState !== 'visible') return;
  liveUnderWay = true;
  liveAsked = performance.now();
  try {
    const [answer, {makeLiveCharts}] = await Promise.all([getLive(), import('/live.mjs')]);
    const span = answer[$('span').value];
    if (span) {
      liveCharts ??= makeLiveCharts($('live-charts'), answer.quantities);
      for (const chart of liveCharts) chart.set(span);
      put('live-charts-note', `${duration(span.bin_s)} a point: band from the smallest to the largest reading, line through the last; ${state.process > 0 ? `written ${number(answer.age_s, 2)} s ago` : 'as the last run has left them'}`);
    } else {
      put('live-charts-note', 'No reading was kept.');
    }
    liveShown = which;
  } catch (error) {
    put('live-charts-note', `They cannot be shown: ${error.message}`);
  }
  liveUnderWay = false;
}

let hasPredictor = false, predictedShown = -1, predictionAsked = -Infinity, predictionUnderWay = false;

async function showPredicted() {
  const due = hasPredictor && state.cycles_complete > 0 && state.cycles_complete !== predictedShown && performance.now() - predictionAsked > PREDICTION_EVERY_MS;
  if (!due || predictionUnderWay || document.visibilityState !== 'visible') return;
  predictionUnderWay = true;
  predictionAsked = performance.now();
  try {
    const answer = await getPrediction();
    showPrediction(answer);
    predictedShown = answer.cycle;
  } catch (error) {
    put('prediction-note', error.message);
  }
  predictionUnderWay = false;
}

let sourcesShown = '';

function showAround() {
  const sources = JSON.stringify([state.sources, clock.zone]);
  if (sources !== sourcesShown) showSources(state.sources, clock);
  sourcesShown = sources;
}

function tell(text, kind) {
  $('answer').hidden = !text;
  $('answer').dataset.kind = kind;
  put('answer', text);
}

// What was shown before is not for whoever stands there now.
function lock(is_locked) {
  locked = is_locked;
  document.querySelector('main').hidden = locked;
  if (!locked) return;
  state = null;
  [alarmsShown, notesShown] = ['', ''];
  for (const id of ['journal', 'alarms', 'notes', 'specimen']) $(id).replaceChildren();  // what became of a quick stop stays
  $('state').dataset.state = 'loading';
  put('state-shape', '○');
  put('state-word', 'Log in to look on');
  put('sentence', '');
  put('campaign', 'strainwave');
  document.title = 'strainwave';
  mustLogIn();
}

function take(newer) {
  if (locked) lock(false);
  if (state && newer.run !== state.run) {
    cyclesShown = measuredShown = predictedShown = -1;
    refresh();  // a token for the new run
  }
  state = newer;
  stateAt = performance.now();
  benchMs = newer.now_ms;
  showsRun(state.run);
  showState();
  showProgress();
  showActs();
  showLists();
  showAround();
  if (asked && state.safe) {
    asked = false;
    tell(`The bench stands: ${state.sentence}`, 'good');
  }
}

async function refresh() {
  try {
    const newer = await getState();
    takeState(newer);
    hasPredictor = newer.has_predictor;
    $('prediction-card').hidden = !hasPredictor;
    clock = new Clock(newer.zone);
    put('zone', `${clock.zone} (${clock.offset(new Date(newer.now_ms))})`);
    wordAt = performance.now();
    take(newer);
    for (const line of newer.events) showLine(line);
    tick();
  } catch (error) {
    if (error.status === 401) lock(true);
    // The banner says it when nothing comes at all.
  }
}

function tick() {
  const silent = !locked && performance.now() - wordAt > SILENT_MS;
  document.body.classList.toggle('old', silent);
  $('banner').hidden = !silent;
  if (silent) {
    const since = benchMs ? `No data since ${clock.time(new Date(benchMs))}` : 'No data yet';
    put('banner', `${since}: the program that serves this page does not answer. The campaign does not depend on it. What stands below is old; trying again.`);
  }
  if (!state) return;
  showLive();
  showPicture(state.picture, (performance.now() - stateAt) / 1000, clock);
  showEnvelopes();
  showCycles();
  showMeasurements();
  showPredicted();
}

begin({refresh, tell});
$('stop').addEventListener('click', async () => {
  if (await quickStop()) asked = true;
});
$('span').addEventListener('change', () => { liveAsked = -Infinity; });
$('all-lines').addEventListener('change', showAllLines);
$('run-hours').addEventListener('change', () => showTimes(...$('journal').children));
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => [...charts, ...pictures ?? [], ...liveCharts ?? []].forEach(chart => chart.restyle()));

let wasDown = false;
follow(({name, data}) => {
  if (name === 'down' || name === 'refused' || name === 'over') {
    wasDown = true;
    if (name !== 'down' && !locked) refresh();  // which is refused, too, where the login is over
    return;
  }
  wordAt = performance.now();
  if (name === 'up' && wasDown) {
    wasDown = false;
    refresh();  // the program may be another one by now, and knows no older token
  }
  if (name === 'state') take(data);
  if (name === 'journal') showLine(data);
  tick();
});
refresh();
setInterval(tick, TICK_MS);

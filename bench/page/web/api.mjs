// SPDX-License-Identifier: Apache-2.0
// Requests to the program that serves the page.

const PATIENCE_MS = 10000;

async function answerOf(path, options) {
  const response = await fetch(path, {signal: AbortSignal.timeout(PATIENCE_MS), ...options});
  const body = await response.json();
  return {ok: response.ok, status: response.status, body};
}

async function get(path) {
  const answer = await answerOf(path);
  if (!answer.ok) throw Object.assign(new Error(answer.body.error), {status: answer.status});
  return answer.body;
}

export const getState = () => get('/api/v1/state');
export const getCycles = points => get(`/api/v1/cycles?points=${points}`);

export const getMeasurements = cycle => get(`/api/v1/measurements?cycle=${cycle}`);
export const getLive = () => get('/api/v1/live');
export const getPrediction = () => get('/api/v1/prediction');
export const getAlarms = () => get('/api/v1/alarms');

const post = (path, body, patience_ms = PATIENCE_MS) => answerOf(path, {
  method: 'POST', headers: {'Content-Type': 'application/json'}, body: JSON.stringify(body), signal: AbortSignal.timeout(patience_ms),
});

/// An action on one run, with a token that is good once; a campaign that goes on takes its time to begin.
export const act = (action, run, token, more = {}) => post('/api/v1/actions', {action, run, token, ...more}, 40000);

/// A password takes a busy machine its time.
export const logIn = (name, password) => post('/api/v1/login', {name, password}, 40000);
export const logOut = () => post('/api/v1/logout', {});

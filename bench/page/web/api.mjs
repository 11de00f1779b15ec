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
  if (!answer.ok) throw new Error(answer.body.error);
  return answer.body;
}

export const getState = () => get('/api/v1/state');
export const getCycles = points => get(`/api/v1/cycles?points=${points}`);

/// An action on one run, with a token that is good once.
export function act(action, run, token) {
  return answerOf('/api/v1/actions', {
    method: 'POST', headers: {'Content-Type': 'application/json'}, body: JSON.stringify({action, run, token}),
  });
}

// SPDX-License-Identifier: Apache-2.0
// Shared by all tabs of a browser: one stream for those that are looked at, none when none is.
import {Stream} from './feed.mjs';

const GONE_MS = 15000;  // a tab that has not said a word for so long was closed without one

const tabs = new Map();  // port -> when it last said that it is looked at
let newest = null;       // the newest state, for a tab that joins a stream which is open already

const stream = new Stream(message => {
  if (message.name === 'state') newest = message;
  if (message.name === 'over') newest = null;
  for (const port of tabs.keys()) port.postMessage(message);
});

function leave(port) {
  tabs.delete(port);
  if (tabs.size > 0) return;
  stream.close();
  newest = null;
}

addEventListener('connect', event => {
  const port = event.ports[0];
  port.addEventListener('message', ({data}) => {
    if (data === 'away') return leave(port);
    const isNew = !tabs.has(port);
    tabs.set(port, performance.now());
    if (isNew && newest) port.postMessage(newest);
    stream.open();
  });
  port.start();
});

setInterval(() => {
  const before = performance.now() - GONE_MS;
  for (const [port, seen] of tabs) if (seen < before) leave(port);
}, GONE_MS / 3);

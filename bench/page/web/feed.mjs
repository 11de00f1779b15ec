// SPDX-License-Identifier: Apache-2.0
// What the bench says, as it says it. One stream a browser, however many tabs: a shared worker holds it. Where a browser
// has none, the tab has a stream of its own.

const RETRY_MS = 2000;
const HERE_MS = 4000;  // how often a tab says that it is still looked at

/// A stream of server-sent events that is opened again whatever ends it. `emit` gets {name, data}.
export class Stream {
  #source = null;
  #retry = 0;
  #emit;

  constructor(emit) {
    this.#emit = emit;
  }

  open() {
    if (this.#source) return;
    clearTimeout(this.#retry);
    const source = this.#source = new EventSource('/api/v1/events');
    for (const name of ['state', 'journal', 'alive']) {
      source.addEventListener(name, event => this.#emit({name, data: JSON.parse(event.data)}));
    }
    source.addEventListener('over', () => this.#emit({name: 'over'}));  // logged out
    source.addEventListener('open', () => this.#emit({name: 'up'}));
    source.addEventListener('error', () => {
      this.#emit({name: source.readyState === EventSource.CLOSED ? 'refused' : 'down'});
      // A refusal is for good to the browser; not to us.
      if (source.readyState !== EventSource.CLOSED || source !== this.#source) return;
      this.close();
      this.#retry = setTimeout(() => this.open(), RETRY_MS);
    });
  }

  close() {
    clearTimeout(this.#retry);
    this.#source?.close();
    this.#source = null;
  }
}

/// Calls `take` with what comes while the tab is looked at; nothing is kept for one that is not, which gets the newest
/// state when it is looked at again.
export function follow(take) {
  let tell;
  const alone = () => {
    const stream = new Stream(take);
    tell = what => what === 'away' ? stream.close() : stream.open();
  };
  if (globalThis.SharedWorker) {
    const worker = new SharedWorker('/feed_worker.mjs', {type: 'module', name: 'strainwave feed'});
    worker.port.addEventListener('message', event => take(event.data));
    worker.port.start();
    tell = what => worker.port.postMessage(what);
    // One that cannot be loaded, for a certificate that the browser trusts in pages alone.
    worker.addEventListener('error', () => {
      alone();
      say();
    });
  } else {
    alone();
  }
  const say = () => tell(document.visibilityState === 'visible' ? 'here' : 'away');
  document.addEventListener('visibilitychange', say);
  addEventListener('pagehide', () => tell('away'));
  addEventListener('pageshow', say);
  setInterval(() => document.visibilityState === 'visible' && tell('here'), HERE_MS);
  say();
}

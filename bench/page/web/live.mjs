// SPDX-License-Identifier: Apache-2.0
// Live channels over time, as bins with their smallest and largest value: one reading that stands out is seen, with its
// right value, however many there were. A fixed number of bins, however long the campaign.
import uPlot from '/uplot.mjs';
import {number} from '/format.mjs';

const UNITS = {degC: '°C', 'm/s2': 'm/s²'};
const color = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

class LiveChart {
  #quantity;
  #unit;
  #plot = null;
  #data = null;
  #span = null;
  #box = document.createElement('div');
  #output = document.createElement('output');

  constructor(parent, {quantity, unit}) {
    this.#quantity = quantity;
    this.#unit = UNITS[unit] ?? unit;
    const article = document.createElement('article'), title = document.createElement('h4');
    article.className = 'chart';
    article.dataset.quantity = quantity;
    title.textContent = `${quantity}, ${this.#unit}`;
    this.#box.className = 'plot';
    article.append(title, this.#output, this.#box);
    parent.append(article);
    new ResizeObserver(() => this.#plot?.setSize(this.#size())).observe(this.#box);
  }

  #size() {
    return {width: Math.max(140, this.#box.clientWidth), height: 150};
  }

  /// @param span  "recent", "whole" of the answer: its bins.
  set(span) {
    const {min, max, last} = span[this.#quantity];
    this.#span = span;
    this.#data = [span.bench_time_s.map(time_s => time_s / 3600), max, min, last];
    if (this.#plot) this.#plot.setData(this.#data); else this.#draw();
    this.#tell(null);
  }

  restyle() {
    this.#plot?.destroy();
    this.#plot = null;
    if (this.#data) this.#draw();
  }

  #draw() {
    const grid = {stroke: color('--line'), width: 1};
    const axis = {stroke: color('--muted'), grid, ticks: {...grid, size: 4}, font: '11px system-ui, sans-serif', labelFont: '11px system-ui, sans-serif'};
    const edge = {stroke: color('--accent') + '99', width: 1, points: {show: false}};
    this.#plot = new uPlot({
      ...this.#size(), legend: {show: false}, cursor: {y: false, drag: {x: false, y: false}},
      scales: {x: {time: false, range: (_, low, high) => low === high ? [low - 0.001, high + 0.001] : [low, high]}},
      axes: [{...axis, label: 'bench time, h', labelSize: 16, size: 26, values: (_, ticks) => ticks.map(tick => number(tick, 6))},
        {...axis, size: 46, values: (_, ticks) => ticks.map(tick => number(tick, 3))}],
      series: [{}, edge, edge, {stroke: color('--accent'), width: 1.3, points: {show: false}}],
      bands: [{series: [1, 2], fill: color('--fill')}],
      hooks: {setCursor: [plot => this.#tell(plot.cursor.idx)]},
    }, this.#data, this.#box);
  }

  // Of the bin under the cursor, else of all of them.
  #tell(at) {
    const [, max, min, last] = this.#data;
    const [from, to] = at === null || at === undefined ? [0, last.length] : [at, at + 1];
    const known = values => values.slice(from, to).filter(value => value !== null);
    if (!known(last).length) {
      this.#output.textContent = 'no value';
      return;
    }
    const low = known(min).reduce((a, b) => Math.min(a, b)), high = known(max).reduce((a, b) => Math.max(a, b));
    const when = to - from === 1 ? `${number(this.#data[0][from], 6)} h: ` : '';
    this.#output.textContent = `${when}${number(low, 5)} to ${number(high, 5)} ${this.#unit}, last ${number(known(last).at(-1), 5)}`;
  }
}

export const makeLiveCharts = (parent, quantities) => quantities.map(quantity => new LiveChart(parent, quantity));

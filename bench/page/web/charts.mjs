// SPDX-License-Identifier: Apache-2.0
// Trends over cycles: smallest to largest of each bin as a band, the last value as a line, its 95 % interval as a wider
// band. A bin hides no value, so one cycle in 100 000 that stands out is seen, with its right value. Lines across: where the
// schedule ends the campaign, and control limits of the first cycles, each with what it is in words.
import uPlot from '/uplot.mjs';
import {fixed, number, withInterval} from '/format.mjs';
import {linesOf, rangeWith} from '/lines.mjs';

const TO_95_PERCENT = 1.96;  // of a normal distribution, from one standard error

export const TRENDS = [
  {quantity: 'k1_Nm_per_rad', title: 'K1', unit: 'Nm/rad'},
  {quantity: 'k2_Nm_per_rad', title: 'K2', unit: 'Nm/rad'},
  {quantity: 'k3_Nm_per_rad', title: 'K3', unit: 'Nm/rad'},
  {quantity: 'e_max_arcmin', title: 'e_max', unit: 'arcmin'},
  {quantity: 'e_avg_arcmin', title: 'e_avg', unit: 'arcmin'},
  {quantity: 'lost_motion_arcmin', title: 'Lost motion', unit: 'arcmin'},
];

// Of 0.025: 3.
const decimalsOf = step => (String(Number(step.toPrecision(6))).split('.')[1] ?? '').length;

const DASHES = {stop: [], control: [7, 5], centre: [2, 4]};

const color = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/// One chart. It is made anew when the theme changes, and holds one set of data at a time.
export class Trend {
  #trend;
  #plot = null;
  #data = null;
  #binCycles = 1;
  #box = document.createElement('div');
  #output = document.createElement('output');
  #article = document.createElement('article');
  #legend = document.createElement('ul');
  #lines = [];
  #all = false;
  #resize;

  constructor(parent, trend) {
    this.#trend = trend;
    this.#article.className = 'chart';
    const title = document.createElement('h3');
    title.textContent = `${trend.title}, ${trend.unit}`;
    this.#box.className = 'plot';
    this.#legend.className = 'legend';
    this.#article.append(title, this.#output, this.#box, this.#legend);
    this.#article.dataset.quantity = trend.quantity;
    parent.append(this.#article);
    this.#resize = new ResizeObserver(() => this.#plot?.setSize(this.#size()));
    this.#resize.observe(this.#box);
  }

  #size() {
    return {width: Math.max(160, this.#box.clientWidth), height: 190};
  }

  /// @param all  whether every line is in the picture, however far off it is.
  set(answer, all) {
    this.#all = all;
    const found = answer.quantities[this.#trend.quantity];
    const half = found.last_standard_error.map(error => error > 0 ? TO_95_PERCENT * error : null);
    const beside = sign => found.last.map((value, i) => value !== null && half[i] ? value + sign * half[i] : null);
    this.#binCycles = answer.bin_cycles;
    this.#article.classList.toggle('binned', answer.bin_cycles > 1);
    this.#data = [answer.cycle, beside(1), beside(-1), found.max, found.min, found.last];
    this.half = half;
    this.flagged = found.flagged;
    this.#lines = linesOf(answer.lines[this.#trend.quantity]);
    if (this.#plot) this.#plot.setData(this.#data); else this.#draw();
    this.#tell(null);
  }

  show(all) {
    this.#all = all;
    this.#plot?.setData(this.#data);
  }

  restyle() {
    this.#plot?.destroy();
    this.#plot = null;
    if (this.#data) this.#draw();
  }

  #draw() {
    const text = color('--muted'), grid = {stroke: color('--line'), width: 1};
    const axis = {stroke: text, grid, ticks: {...grid, size: 4}, font: '12px system-ui, sans-serif'};
    const band = {stroke: 'transparent', points: {show: false}};
    const few = this.#data[0].length <= 40;
    this.#plot = new uPlot({
      ...this.#size(),
      legend: {show: false},
      cursor: {y: false, drag: {x: false, y: false}},
      scales: {x: {time: false, range: (_, low, high) => low === high ? [low - 1, high + 1] : [low, high]},
        y: {range: (_, low, high) => low === null ? [0, 1] : rangeWith(low, high, this.#lines, this.#all)}},
      axes: [
        {...axis, label: 'cycle', labelFont: axis.font, labelSize: 18, size: 28, values: (_, ticks) => ticks.map(t => Number.isInteger(t) ? number(t, 9) : '')},
        {...axis, size: 56, values: (_, ticks, column, space, step) => ticks.map(t => fixed(t, decimalsOf(step)))},
      ],
      series: [{}, band, band, {...band, stroke: color('--accent') + '66'}, {...band, stroke: color('--accent') + '66'},
        {stroke: color('--accent'), width: 1.5, points: {show: few, size: 5, fill: color('--accent')}}],
      bands: [{series: [1, 2], fill: color('--fill-wide')}, {series: [3, 4], fill: color('--fill')}],
      hooks: {setCursor: [plot => this.#tell(plot.cursor.idx)], draw: [plot => this.#drawLines(plot)]},
    }, this.#data, this.#box);
  }

  // Over the whole width; what is outside of the picture is said below it.
  #drawLines(plot) {
    const {ctx, bbox} = plot;
    const {min, max} = plot.scales.y;
    const isInside = value => value >= min && value <= max;
    const colors = {stop: color('--bad'), control: color('--warn'), centre: color('--warn')};
    ctx.save();
    for (const {kind, at, centre} of this.#lines) {
      for (const [name, value] of [...at.map(value => [kind, value]), ...centre === undefined ? [] : [['centre', centre]]]) {
        if (!isInside(value)) continue;
        const y = plot.valToPos(value, 'y', true);
        ctx.beginPath();
        ctx.setLineDash(DASHES[name].map(length => length * devicePixelRatio));
        ctx.lineWidth = (name === 'stop' ? 2 : 1.2) * devicePixelRatio;
        ctx.strokeStyle = colors[name];
        ctx.moveTo(bbox.left, y);
        ctx.lineTo(bbox.left + bbox.width, y);
        ctx.stroke();
      }
    }
    ctx.restore();
    this.#legend.replaceChildren(...this.#lines.map(({kind, at, words}) => {
      const item = document.createElement('li');
      item.dataset.kind = kind;
      const missing = at.filter(value => !isInside(value));
      const where = missing.length ? ` (${missing.length < at.length ? 'one of them ' : ''}not in the picture, ${missing[0] < min ? 'below' : 'above'} it)` : '';
      item.textContent = words + where;
      return item;
    }));
  }

  // Of the bin under the cursor, else the last one with a value.
  #tell(at) {
    const [cycles, , , max, min, last] = this.#data;
    let i = at ?? cycles.length - 1;
    while (at === null && i > 0 && last[i] === null) --i;
    if (!cycles.length || last[i] === null || last[i] === undefined) {
      this.#output.textContent = 'no value';
      return;
    }
    const first = Math.max(1, cycles[i] - this.#binCycles + 1);
    const value = withInterval(last[i], this.half[i]) + (this.half[i] ? ' (95 %)' : '');
    const envelope = first < cycles[i] ? `cycles ${first} to ${cycles[i]}: ${number(min[i], 6)} to ${number(max[i], 6)}, last ${value}`
      : `cycle ${cycles[i]}: ${value}`;
    this.#output.textContent = envelope + (this.flagged[i] ? `, ${this.flagged[i]} flagged` : '');
  }
}

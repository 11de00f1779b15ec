// SPDX-License-Identifier: Apache-2.0
// What a cycle has measured, the newest over the first: the hysteresis loop, the error over one turn, the spectrum.
import uPlot from '/uplot.mjs';
import {number} from '/format.mjs';

const color = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

const CURVES = [
  {title: 'Hysteresis', x: 'torque, Nm', y: 'twist, arcmin', of: cycle => cycle.hysteresis && [[cycle.hysteresis.torque_Nm, cycle.hysteresis.twist_arcmin]],
    note: cycle => cycle.hysteresis?.lock_angle_deg === null ? '' : `at lock angle ${cycle.hysteresis?.lock_angle_deg}°`},
  {title: 'Transmission error', x: 'output angle, °', y: 'error, arcmin', xRange: [0, 360], note: () => 'cw drawn out, ccw dashed',
    of: cycle => cycle.transmission_error && ['cw', 'ccw'].map(way => cycle.transmission_error[way]).map(turn => turn && [turn.angle_deg, turn.error_arcmin])},
  {title: 'Vibration', x: 'frequency, Hz', y: 'amplitude, m/s²', log: true, note: cycle => channelOf(cycle)?.replace(/_m_per_s2$/, '') ?? '',
    of: cycle => channelOf(cycle) && [[cycle.spectrum[channelOf(cycle)].frequency_Hz.slice(1), cycle.spectrum[channelOf(cycle)].amplitude_m_per_s2.slice(1)]]},
];

// The first accelerometer of the output side, else the first there is.
function channelOf(cycle) {
  const names = Object.keys(cycle.spectrum ?? {});
  return names.find(name => !name.includes('motor')) ?? names[0];
}

// Lines through points in their own order: a loop goes back and forth.
function drawn(dash) {
  return (plot, index) => {
    uPlot.orient(plot, index, (series, xs, ys, scaleX, scaleY, toX, toY, left, top, width, height) => {
      const {ctx} = plot;
      ctx.save();
      ctx.beginPath();
      ctx.rect(left, top, width, height);
      ctx.clip();
      ctx.beginPath();
      plot.data[index][0].forEach((x, i) => {
        const y = plot.data[index][1][i];
        if (x === null || y === null) return;
        ctx.lineTo(toX(x, scaleX, width, left), toY(y, scaleY, height, top));
      });
      ctx.strokeStyle = series.stroke();
      ctx.lineWidth = series.width * devicePixelRatio;
      ctx.setLineDash(dash);
      ctx.stroke();
      ctx.restore();
    });
    return null;
  };
}

class Picture {
  #plot = null;
  #draw = () => {};
  #box = document.createElement('div');
  #output = document.createElement('output');
  #article = document.createElement('article');

  constructor(parent, curve) {
    this.curve = curve;
    this.#article.className = 'chart binned';
    const title = document.createElement('h3');
    title.textContent = `${curve.title}`;
    this.#box.className = 'plot';
    this.#article.append(title, this.#output, this.#box);
    parent.append(this.#article);
    new ResizeObserver(() => this.#plot?.setSize(this.#size())).observe(this.#box);
  }

  #size() {
    return {width: Math.max(160, this.#box.clientWidth), height: 190};
  }

  /// @param cycles  the first and the newest, or one alone.
  set(cycles) {
    const measured = cycles.filter(cycle => this.curve.of(cycle));
    this.#article.hidden = measured.length === 0;
    if (!measured.length) return;
    const newest = measured.at(-1);
    const which = measured.length > 1 ? `cycle ${newest.cycle} over cycle ${measured[0].cycle} (pale)` : `cycle ${newest.cycle}`;
    this.#output.textContent = [which, this.curve.note(newest)].filter(Boolean).join(', ');
    this.#draw = () => this.#show(measured);
    this.restyle();
  }

  #show(measured) {
    const text = color('--muted'), grid = {stroke: color('--line'), width: 1};
    const axis = {stroke: text, grid, ticks: {...grid, size: 4}, font: '12px system-ui, sans-serif', labelFont: '12px system-ui, sans-serif', labelSize: 18};
    const series = [{}], data = [null];
    measured.forEach((cycle, k) => this.curve.of(cycle).forEach((points, way) => {
      if (!points) return;
      const last = k === measured.length - 1;
      data.push(points);
      series.push({facets: [{scale: 'x', auto: true}, {scale: 'y', auto: true}], stroke: color(last ? '--accent' : '--pale'), width: last ? 1.3 : 2.4, paths: drawn(way ? [4, 4] : [])});
    }));
    this.#plot = new uPlot({
      ...this.#size(), mode: 2, legend: {show: false}, cursor: {show: false},
      scales: {x: {time: false, ...(this.curve.xRange ? {range: this.curve.xRange} : {})}, y: this.curve.log ? {distr: 3, log: 10} : {}},
      axes: [{...axis, label: this.curve.x, size: 28, values: (_, ticks) => ticks.map(tick => number(tick))},
        {...axis, label: this.curve.y, size: 52, values: (_, ticks) => ticks.map(tick => tick === null ? '' : number(tick, 3))}],
      series,
    }, data, this.#box);
  }

  restyle() {
    this.#plot?.destroy();
    this.#plot = null;
    this.#draw();
  }
}

export const makePictures = parent => CURVES.map(curve => new Picture(parent, curve));

// SPDX-License-Identifier: Apache-2.0
// Lines across a trend, in words, and how much of the picture they may take. Pure functions.
import {number} from './format.mjs';

// A line that would make the picture more than so many times as high is left outside, unless it is asked for.
const MOST_STRETCH = 4;

const cycleWords = cycle => cycle === null ? 'never' : String(Math.round(cycle));

/// What a trend is held against, in words, with where each line is drawn.
export function linesOf({stop, forecast, control}) {
  const lines = [];
  if (stop) {
    const way = 'below' in stop ? 'below' : 'above';
    lines.push({kind: 'stop', at: [stop[way]], words: `the campaign ends ${way} ${number(stop[way], 5)}`});
  }
  if (forecast) {
    const {cycle, low, high, level} = forecast;
    lines.push({kind: 'forecast', at: [],
      words: `forecast of that: cycle ${cycleWords(cycle)} (${cycleWords(low)} to ${cycleWords(high)}, ${100 * level} %)`});
  }
  if (control) {
    lines.push({kind: 'control', at: [control.lower, control.upper], centre: control.centre,
      words: `control limits ${number(control.lower, 5)} to ${number(control.upper, 5)}: mean ± 2.66 mean moving ranges of ${control.cycles} cycles, ${control.first_cycle} to ${control.last_cycle}`});
  }
  return lines;
}

/// Of the vertical axis: with the lines, where they do not press the values together.
export function rangeWith(low, high, lines, all) {
  let [from, to] = [low, high];
  const height = high - low || Math.abs(high) || 1;
  for (const value of lines.flatMap(line => line.at)) {
    const [wider, higher] = [Math.min(from, value), Math.max(to, value)];
    if (all || higher - wider <= MOST_STRETCH * height) [from, to] = [wider, higher];
  }
  const margin = 0.06 * (to - from || Math.abs(to) || 1);
  return [from - margin, to + margin];
}

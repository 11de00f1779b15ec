// SPDX-License-Identifier: Apache-2.0
// Numbers and times as people read them. Pure functions.

export function number(value, digits = 4) {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  const text = Number(value).toPrecision(digits);
  const grouped = {maximumFractionDigits: 10, useGrouping: Math.abs(value) >= 1e4};
  return withMinus(String(Number(text)).includes('e') ? text : Number(text).toLocaleString('en-GB', grouped));
}

const withMinus = text => text.replace('-', '−');

/// With so many decimals, so that a column of changing values stands still.
export function fixed(value, decimals) {
  const grouped = {minimumFractionDigits: decimals, maximumFractionDigits: decimals, useGrouping: Math.abs(value) >= 1e4};
  return withMinus(value.toLocaleString('en-GB', grouped));
}

/// A value with the half-width of its 95 % interval, to the digits that this leaves.
export function withInterval(value, halfWidth) {
  if (!Number.isFinite(value)) return '–';
  if (!(halfWidth > 0)) return number(value, 5);
  const decimals = Math.min(6, Math.max(0, 1 - Math.floor(Math.log10(halfWidth))));
  return `${fixed(value, decimals)} ± ${fixed(halfWidth, decimals)}`;
}

const UNITS = {Nm_per_rad: 'Nm/rad', m_per_s2: 'm/s²', degC: '°C', percent: '%'};

/// "K2, Nm/rad" of "k2_Nm_per_rad".
export function quantityName(name) {
  const [, what, unit] = name.match(/^(.+?)_(Nm_per_rad|m_per_s2|arcmin|arcsec|percent|degC|Nm|rad|deg|rpm|Hz|s)$/) ?? [null, name, ''];
  const words = what.replace(/^k(\d)$/, 'K$1').replace(/^e_/, 'e\u2009').replaceAll('_', ' ').replace('\u2009', '_');
  return unit ? `${words}, ${UNITS[unit] ?? unit}` : words;
}

export function duration(seconds) {
  if (!Number.isFinite(seconds)) return '–';
  const s = Math.max(0, Math.round(seconds));
  if (s < 60) return `${s} s`;
  if (s < 3600) return `${Math.floor(s / 60)} min ${s % 60} s`;
  if (s < 86400) return `${Math.floor(s / 3600)} h ${Math.floor(s % 3600 / 60)} min`;
  return `${Math.floor(s / 86400)} d ${Math.floor(s % 86400 / 3600)} h`;
}

export function hours(seconds) {
  return `${(seconds / 3600).toLocaleString('en-GB', {minimumFractionDigits: 2, maximumFractionDigits: 2, useGrouping: seconds >= 3.6e7})} h`;
}

export function bytes(count) {
  const units = ['B', 'kB', 'MB', 'GB', 'TB'];
  let unit = 0;
  while (count >= 1000 && unit < units.length - 1) {
    count /= 1000;
    ++unit;
  }
  return `${number(count, 3)} ${units[unit]}`;
}

export function percent(share, digits = 0) {
  return Number.isFinite(share) ? `${(100 * share).toFixed(digits)} %` : '–';
}

/// The bench's own time with its offset from UTC, whatever the zone of the browser is.
export class Clock {
  constructor(zone) {
    this.zone = zone || 'UTC';
    const common = {timeZone: this.zone, hourCycle: 'h23'};
    try {
      new Intl.DateTimeFormat('en-GB', common);
    } catch {
      this.zone = common.timeZone = 'UTC';
    }
    this.offsetFormat = new Intl.DateTimeFormat('en-GB', {...common, timeZoneName: 'longOffset'});
    this.timeFormat = new Intl.DateTimeFormat('en-GB', {...common, hour: '2-digit', minute: '2-digit', second: '2-digit'});
    this.dateFormat = new Intl.DateTimeFormat('en-GB', {...common, day: '2-digit', month: 'short', year: 'numeric'});
  }

  /// "UTC+01:00", at that moment: it changes with summer time.
  offset(date) {
    const part = this.offsetFormat.formatToParts(date).find(p => p.type === 'timeZoneName');
    const offset = part.value.replace('GMT', '');
    return offset ? `UTC${offset}` : 'UTC';
  }

  time(date) {
    return this.timeFormat.format(date);
  }

  full(date) {
    return `${this.dateFormat.format(date)} ${this.time(date)}`;
  }
}

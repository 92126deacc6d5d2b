// SPDX-License-Identifier: Apache-2.0
// SI quantities as the page writes them: one unit per quantity.
export const units = {
  length: {factor: 1e3, name: "mm"},
  angle: {factor: 180 / Math.PI, name: "deg"},
  force: {factor: 1, name: "N"},
  stiffness: {factor: 1, name: "N/m"},
};

// Three significant digits, but no more than four decimals.
export function digits(value) {
  if (value === 0) return "0";
  const size = Math.abs(value);
  const decimals = size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : size >= 0.1 ? 3 : 4;
  return value.toFixed(decimals);
}

export const inUnit = (value, kind) => digits(value * units[kind].factor);

// The same without zeros at its end.
export const plain = (value, kind) => `${Number((value * units[kind].factor).toPrecision(3))} ${units[kind].name}`;

// The largest 1, 2 or 5 times a power of ten that is not above `value`.
export function roundStep(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  const times = value / power;
  return (times >= 5 ? 5 : times >= 2 ? 2 : 1) * power;
}

// SPDX-License-Identifier: Apache-2.0
// The data that `tactus view` puts into the page: bytes in base64, and columns as cli/viewer/columns.h writes them.
export function bytesOf(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}

export function readColumn({step, count, data}) {
  const bytes = bytesOf(data);
  const out = new Float64Array(count);
  let at = 0;
  const number = () => {
    let value = 0;
    for (let factor = 1; ; factor *= 128) {
      const byte = bytes[at++];
      value += (byte & 127) * factor;
      if (byte < 128) return value;
    }
  };
  let value = 0;
  for (let i = 0; i < count;) {
    const code = number();
    if (code === 0) {
      const end = i + number() + 1;
      out.fill(value * step, i, end);
      i = end;
    } else {
      value += code % 2 === 0 ? code / 2 : -(code + 1) / 2;
      out[i++] = value * step;
    }
  }
  return out;
}

export const readColumns = (columns) => Object.fromEntries(Object.entries(columns).map(([name, column]) => [name, readColumn(column)]));

// Index of the last element that is not above `value`; -1: none.
export function lastUpTo(sorted, value) {
  let low = 0;
  let high = sorted.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (sorted[middle] <= value) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

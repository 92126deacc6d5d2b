// SPDX-License-Identifier: Apache-2.0
// Pixels of a screenshot: PNG of 8 bits per channel, RGB or RGBA, not interlaced.
import {inflateSync} from "node:zlib";

export function readPng(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
  const [width, height] = [view.getUint32(16), view.getUint32(20)];
  const channels = bytes[25] === 6 ? 4 : 3;
  const parts = [];
  for (let at = 8; at < bytes.length; at += 12 + view.getUint32(at))
    if (bytes.toString("latin1", at + 4, at + 8) === "IDAT") parts.push(bytes.subarray(at + 8, at + 8 + view.getUint32(at)));
  const raw = inflateSync(Buffer.concat(parts));
  const row = width * channels;
  const pixels = new Uint8Array(row * height);
  for (let y = 0; y < height; ++y) {
    const filter = raw[y * (row + 1)];
    for (let x = 0; x < row; ++x) {
      const a = x >= channels ? pixels[y * row + x - channels] : 0;
      const b = y > 0 ? pixels[(y - 1) * row + x] : 0;
      const c = x >= channels && y > 0 ? pixels[(y - 1) * row + x - channels] : 0;
      pixels[y * row + x] = raw[y * (row + 1) + 1 + x] + [0, a, b, (a + b) >> 1, paeth(a, b, c)][filter];
    }
  }
  return {width, height, at: (x, y) => Array.from(pixels.subarray(y * row + x * channels, y * row + x * channels + 3))};
}

function paeth(a, b, c) {
  const [pa, pb, pc] = [Math.abs(b - c), Math.abs(a - c), Math.abs(a + b - 2 * c)];
  return pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
}

// Smallest box around the pixels in which two pictures differ: [left, top, right, bottom].   in  within  the box to look at
export function differingBox(one, other, within = [0, 0, one.width, one.height]) {
  let box = [Infinity, Infinity, -1, -1];
  for (let y = within[1]; y < within[3]; ++y) {
    for (let x = within[0]; x < within[2]; ++x) {
      const [a, b] = [one.at(x, y), other.at(x, y)];
      if (a.every((value, k) => Math.abs(value - b[k]) < 8)) continue;
      box = [Math.min(box[0], x), Math.min(box[1], y), Math.max(box[2], x), Math.max(box[3], y)];
    }
  }
  return box;
}

// SPDX-License-Identifier: Apache-2.0
// Colours of style.css for what is drawn on a canvas; they follow the light or dark of the system.
const dark = matchMedia("(prefers-color-scheme: dark)");

export function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

export function onThemeChange(react) {
  dark.addEventListener("change", react);
}

// A map from 0..1 to colours whose lightness rises evenly: viridis, eleven of its points.
const stops = [0x440154, 0x482475, 0x414487, 0x355f8d, 0x2a788e, 0x21918c, 0x22a884, 0x44bf70, 0x7ad151, 0xbddf26, 0xfde725];

export const mapSteps = 256;
export const map = Array.from({length: mapSteps}, (_, i) => {
  const position = (i / (mapSteps - 1)) * (stops.length - 1);
  const low = Math.min(Math.floor(position), stops.length - 2);
  const part = (stop, shift) => (stops[stop] >> shift) & 255;
  return [16, 8, 0].map((shift) => Math.round(part(low, shift) * (low + 1 - position) + part(low + 1, shift) * (position - low)));
});

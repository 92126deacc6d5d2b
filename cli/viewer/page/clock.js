// SPDX-License-Identifier: Apache-2.0
// Time of the page: plays at any speed, stops or begins again at the end.
export const speeds = [0.01, 0.05, 0.1, 0.25, 0.5, 1, 2, 4, 8];

export class Clock {
  #before = null;

  constructor(duration, changed) {
    this.duration = duration;
    this.changed = changed;
    this.time = 0;
    this.speed = 1;
    this.loops = false;
    this.plays = false;
  }

  seek(time) {
    this.time = Math.min(Math.max(time, 0), this.duration);
    this.changed();
  }

  toggle(plays = !this.plays) {
    if (plays && this.time >= this.duration) this.time = 0;
    this.plays = plays;
    this.#before = null;
    this.changed();
  }

  // Called before each picture.   in  now [ms]
  advance(now) {
    if (this.plays && this.#before !== null) {
      this.time += ((now - this.#before) / 1000) * this.speed;
      if (this.time >= this.duration) {
        if (this.loops) this.time %= Math.max(this.duration, 1e-9);
        else this.time = this.duration, (this.plays = false);
      }
      this.changed();
    }
    this.#before = this.plays ? now : null;
  }
}

// "#t=3.25" as seconds, or null.
export function timeOfLink(hash) {
  const match = /^#t=(\d{1,9}(?:\.\d{1,9})?)$/.exec(hash);
  return match ? Number(match[1]) : null;
}

// SPDX-License-Identifier: Apache-2.0
// Time of the page: plays at any speed, stops or begins again at the end; or follows an end that moves.
export const speeds = [0.01, 0.05, 0.1, 0.25, 0.5, 1, 2, 4, 8];

export class Clock {
  #before = null;

  constructor(duration, changed) {
    this.start = 0;
    this.duration = duration;
    this.changed = changed;
    this.time = 0;
    this.speed = 1;
    this.loops = false;
    this.plays = false;
    this.isLive = false;
    this.follows = false;
  }

  seek(time) {
    this.follows = false;
    this.time = Math.min(Math.max(time, this.start), this.duration);
    this.changed();
  }

  // Of a live page: show the newest tick.
  follow() {
    this.follows = true;
    this.plays = false;
    this.time = this.duration;
    this.changed();
  }

  // Of a live page: there is more at the end, and less at the start.
  move(start, duration) {
    this.start = start;
    this.duration = duration;
    this.time = this.follows ? duration : Math.max(this.time, start);
    this.changed();
  }

  toggle(plays = !this.plays && !this.follows) {
    if (plays && this.time >= this.duration) {
      if (this.isLive) return this.follow();
      this.time = 0;
    }
    this.follows = false;
    this.plays = plays;
    this.#before = null;
    this.changed();
  }

  // Called before each picture.   in  now [ms]
  advance(now) {
    if (this.plays && this.#before !== null) {
      this.time += ((now - this.#before) / 1000) * this.speed;
      if (this.time >= this.duration) {
        if (this.isLive) return this.follow();
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

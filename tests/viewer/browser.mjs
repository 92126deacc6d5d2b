// SPDX-License-Identifier: Apache-2.0
// A real browser without a window: `open` gives a tab, which is asked by `run` and `until` and moved by `key` and `click`.
import {Chromium} from "./chromium.mjs";
import {Firefox} from "./firefox.mjs";

export const isFirefox = (program) => program.startsWith("firefox");

// in  program  chromium or firefox-esr
export const launch = (program, {webGl = true} = {}) => (isFirefox(program) ? Firefox : Chromium).launch(program, {webGl});

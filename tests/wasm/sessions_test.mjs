// SPDX-License-Identifier: Apache-2.0
// sessions_test.mjs CONFORMANCE MODULE: sessions and clients with a device in WebAssembly over their conformance vectors.
import assert from "node:assert/strict";
import {readFileSync} from "node:fs";
import {readSessions} from "./read_vectors.mjs";
import {checkSession, loadSessions} from "./sessions.js";

const [conformance, module] = process.argv.slice(2);
const answer = await loadSessions(readFileSync(module));
const sessions = readSessions(conformance);
const devices = sessions.filter(({isSession}) => !isSession).length;
assert.ok(devices > 10 && sessions.length - devices > 60);
assert.deepEqual(sessions.map((one) => [one.id, checkSession(answer, one)]).filter(([, problem]) => problem !== null), []);
console.log(`${sessions.length - devices} scripts of sessions and ${devices} streams with a device, all answers as expected`);

// The check can fail.
const one = sessions.find(({isSession}) => isSession);
const withExpected = (expected) => checkSession(answer, {...one, expected});
assert.match(withExpected(one.expected.replace("joining", "live")), /line 0 is/);
assert.match(withExpected(`${one.expected}{}\n`), /line \d+ is|lines, not/);
assert.equal(checkSession(answer, {...one, input: btoa('{"at":0,"heard":"xy"}')}), "the script cannot be read");
